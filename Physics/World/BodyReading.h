// Access to a body for a getter of BodyInterface, which locks the world if the interface does. Getters of what a step
// changes while it lets queries in (velocities, whether a body is awake) ask for Access::Reads, the others for Queries.
#pragma once

#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Physics/Misuse.h>
#include <Fulcrum/Physics/World/WorldState.h>

#include <optional>

namespace fulcrum {

// Whether the world may be read at all; what may not is reported.
inline bool IsReadable(const WorldState& world) {
    if (!world.lock.IsBroken()) [[likely]]
        return true;
    ReportMisuse(*world.lock.RefusalOfBroken());
    return false;
}

class BodyReading {
public:
    BodyReading(WorldState& world, bool locks, BodyId id, WorldLock::Access access = WorldLock::Access::Queries) {
        // In callbacks of a step and of changes the thread has the world already.
        if (locks && WorldLock::OfThisThread(world.lock) != WorldLock::Access::Changes) {
            shared_.emplace(world.lock, access);
            if (shared_->Refusal()) {
                ReportMisuse(*shared_->Refusal());
                return;
            }
        }
        exists_ = (shared_ || IsReadable(world)) && world.bodies.Find(id);
    }
    // Whether the body exists and may be read.
    explicit operator bool() const { return exists_; }

private:
    const DefaultFloats floats_;
    std::optional<WorldLock::Shared> shared_;
    bool exists_ = false;
};

}  // namespace fulcrum
