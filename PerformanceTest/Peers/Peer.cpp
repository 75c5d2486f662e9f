#include <Fulcrum/PerformanceTest/Peers/Peer.h>

#include <Fulcrum/Samples/Runner/CommandLine.h>

namespace fulcrum {

#ifdef FULCRUM_PEER_BULLET
namespace BulletPeer {
extern const Peer kPeer;
}
#endif

Result<const Peer*> FindPeer(const std::string& name, [[maybe_unused]] const std::string& command) {
    const std::string known[] = {"bullet"};
    if (name != known[0]) return UnknownName("peer", name, known);
#ifdef FULCRUM_PEER_BULLET
    return &BulletPeer::kPeer;
#else
    return Error{ErrorCode::Unsupported, "this program was built without " + name + "; ./fulcrum " + command +
                                             " --peer " + name +
                                             " builds it in, as does cmake -DFULCRUM_PEER_BULLET=ON"};
#endif
}

}  // namespace fulcrum
