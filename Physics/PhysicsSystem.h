// A world of rigid bodies. Create it, add bodies through Bodies(), call Update once a frame. One thread at a time
// changes it; Queries() may be asked by any number of threads at any time.
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Physics/BodyInterface.h>
#include <Fulcrum/Physics/ContactListener.h>
#include <Fulcrum/Physics/JointInterface.h>
#include <Fulcrum/Physics/QueryInterface.h>
#include <Fulcrum/Physics/SensorEvent.h>
#include <Fulcrum/Physics/Snapshot.h>
#include <Fulcrum/Physics/StepEvents.h>
#include <Fulcrum/Physics/StepObserver.h>
#include <Fulcrum/Physics/StepReport.h>

#include <memory>
#include <span>

namespace fulcrum {

struct StepState;
struct SnapshotRoom;

class PhysicsSystem {
public:
    // `jobs` (not owned, may be null: no threads) must outlive the system. Errors name the field: NonFinite,
    // NonPositive, Negative, OutOfRange, Unsupported (layerCollides not symmetric).
    static Result<std::unique_ptr<PhysicsSystem>> Create(const SystemSettings& settings = {},
                                                         JobSystem* jobs = nullptr);
    ~PhysicsSystem();
    PhysicsSystem(const PhysicsSystem&) = delete;
    PhysicsSystem& operator=(const PhysicsSystem&) = delete;

    // Advances by dt seconds, 0 .. 1; less than a nanosecond changes nothing. Errors: NonFinite, OutOfRange: nothing
    // has happened then.
    Status Update(double dt);

    BodyInterface& Bodies() { return bodies_; }
    const BodyInterface& Bodies() const { return bodies_; }
    JointInterface& Joints() { return joints_; }
    const JointInterface& Joints() const { return joints_; }
    const QueryInterface& Queries() const { return queries_; }
    const StepReport& Report() const;
    // Contacts, bodies, broken joints: what happened in the last step, as far as Settings().events asks for it. Valid
    // until the next. Not to be asked in what a step calls back: that is reported (Misuse.h), and there is nothing.
    const StepEvents& Events() const;
    // What sensors saw in the last step, sorted by sensor, time, body. Valid until the next.
    std::span<const SensorEvent> SensorEvents() const;
    // What was inside a sensor when the last step ended, sorted; bodies removed since then are among them. Valid until
    // the next step and until a sensor is created. Empty for what is no sensor.
    std::span<const BodyId> BodiesInside(BodyId sensor) const;
    const SystemSettings& Settings() const;
    // As for Create. Takes effect at the next step. Where layerCollides changes, contacts that no longer may be end,
    // those that now may be are found, and the bodies of these layers wake.
    Status SetSettings(const SystemSettings& settings);
    // Asks it about contacts from now on (not owned, must outlive its use); null: nobody. Pairs that exist are asked
    // about again, and bodies wake whose contact it forbids.
    void SetContactListener(const ContactListener* listener);

    // Tells it of steps and their stages from now on (not owned, must outlive its use); null: nobody. Not part of
    // snapshots.
    void SetStepObserver(StepObserver* observer);

    // The whole state as bytes, from which steps go on with the same bits: `bytes` are overwritten, and allocated anew
    // only where they do not suffice. Shapes, group filters and what joints of one's own are made of are named, not
    // contained. Error: Unsupported (a body's mutable compound has a custom child); `bytes` are empty then.
    Status SaveSnapshot(std::vector<std::byte>& bytes) const;
    // Back to the state of a snapshot of this world, or of another one with the same calls before it: settings, bodies,
    // joints and their ids are as they were then. The report is still that of the last step. Errors, after which
    // nothing has changed: Unsupported (no snapshot; another version or build; a contact listener is set where none
    // was, or the other way round), Degenerate (damaged), UnknownId (what it names is neither in the world nor given).
    // Bytes that were forged are not noticed: load only what you trust.
    Status RestoreSnapshot(std::span<const std::byte> bytes, const SnapshotSources& sources = {});
    // Some bodies alone, and the joints between them: poses, velocities, forces that wait for the next step, how long
    // they have been slow; what joints carry, their limits and motors. Error: UnknownId.
    Status SaveBodies(std::span<const BodyId> bodies, std::vector<std::byte>& bytes) const;
    // Puts them back there, awake; all else stays as it is. Contacts begin anew, as after SetPose, so that what follows
    // is not the same to the last bit. Errors, after which nothing has changed: Unsupported and Degenerate as above;
    // UnknownId (one of the bodies or joints does not exist), Unsupported also where a body has another shape since, or
    // a joint another type.
    Status RestoreBodies(std::span<const std::byte> bytes);
    // A hash, 64 bits, of the whole state but for user data: equal hashes mean that the same calls give the same bits
    // from now on. The same for any number of threads and lanes. 0 where it is called back by a step.
    uint64_t HashState() const;

    // All bodies, in the order of their indices.
    void VisitBodies(FunctionRef<void(BodyId)> visit) const;
    // All awake contacts with at least one point as they were solved in the last step, in a deterministic order; those
    // that are only near are among them.
    void VisitContacts(FunctionRef<void(const ContactView&)> visit) const;
    // Those of one body, by pair; nothing for an unknown id.
    void VisitContactsOf(BodyId body, FunctionRef<void(const ContactView&)> visit) const;
    // Calls visit(id, island) for each dynamic body; islands are numbered from 0 in the order of their smallest body
    // index. Found anew by this call: for viewers and tests.
    void VisitIslands(FunctionRef<void(BodyId, uint32_t island)> visit) const;
    // Kinetic plus gravitational potential energy of the dynamic bodies, J; the potential is zero at the world's
    // origin.
    double GetEnergy() const;
    // FNV-1a, 64 bits, of all bodies' poses (position, rotation x y z w as doubles) in the order of their indices.
    uint64_t HashPoses() const;
    // Bytes held by the system, all buffers included.
    size_t MemoryUsed() const;

private:
    PhysicsSystem(std::unique_ptr<WorldState> world, std::unique_ptr<StepState> step);
    std::unique_ptr<WorldState> world_;
    std::unique_ptr<StepState> step_;
    std::unique_ptr<SnapshotRoom> snapshots_;
    BodyInterface bodies_;
    JointInterface joints_;
    QueryInterface queries_;
};

}  // namespace fulcrum
