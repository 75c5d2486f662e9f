#include <Fulcrum/Physics/World/SeenPoses.h>

namespace fulcrum {

void SeenPoses::Note(const BodyStore& bodies, JobSystem& jobs) {
    ++note_;
    seen_.resize(bodies.Size());
    jobs.ParallelFor(static_cast<uint32_t>(bodies.awake.size()), 256, [&](JobRange range) {
        for (uint32_t i = range.begin; i < range.end; ++i) {
            const uint32_t body = bodies.awake[i];
            seen_[body] = {bodies.CenterPoseOf(body), bodies.remainders[body].value, note_};
        }
    });
}

}  // namespace fulcrum
