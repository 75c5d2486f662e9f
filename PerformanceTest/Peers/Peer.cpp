#include <Fulcrum/PerformanceTest/Peers/Peer.h>

namespace fulcrum {

#ifdef FULCRUM_PEER_BULLET
namespace BulletPeer {
extern const Peer kPeer;
}
#endif

std::vector<const Peer*> BuiltPeers() {
#ifdef FULCRUM_PEER_BULLET
    return {&BulletPeer::kPeer};
#else
    return {};
#endif
}

std::vector<std::string> PeerNames() { return {"bullet"}; }

}  // namespace fulcrum
