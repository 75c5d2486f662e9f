// Bodies that are created together: checked beforehand, on a loader thread while the world steps, say, and then added
// by one call. A plain value without a world: to abort is to drop it. Different threads may use different batches.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Physics/Settings.h>

#include <span>
#include <vector>

namespace fulcrum {

class BodyBatch {
public:
    // Errors: that of BodyInterface::Create for the first settings that are wrong, named as `bodies[3]: ...`.
    static Result<BodyBatch> Prepare(std::vector<BodySettings> bodies);

    std::span<const BodySettings> Bodies() const { return bodies_; }

private:
    explicit BodyBatch(std::vector<BodySettings> bodies) : bodies_(std::move(bodies)) {}
    std::vector<BodySettings> bodies_;
};

}  // namespace fulcrum
