// A world of rigid bodies. Create it, add bodies through Bodies(), call Update once per frame. Changes, steps and
// Queries() may be called by any thread at any time: each is seen by the others before or after, never half. Changes
// wait for a step to end, queries do not. What else reads the world (getters of Bodies() and Joints(), events, reports,
// visits) does not lock it: call it while no other thread changes or steps the world, or under Queries().Hold(). A call
// that throws, as where memory runs out, has changed nothing; a step, or RestoreSnapshot, that does leaves a world that
// refuses everything but RestoreSnapshot (Docs/Embedding.md).
#pragma once

#include <Fulcrum/Jobs/JobSystem.h>
#include <Fulcrum/Math/Memory.h>
#include <Fulcrum/Physics/BodyInterface.h>
#include <Fulcrum/Physics/CallObserver.h>
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
    // `jobs` (not owned, may be null: no threads) must outlive the system, and so must `memory` (not owned, may be
    // null: operator new), from which it takes all of its memory. Shapes are not part of it: they may outlive the
    // world. Errors name the field: NonFinite, NonPositive, Negative, OutOfRange, Unsupported (layerCollides not
    // symmetric).
    static Result<std::unique_ptr<PhysicsSystem>> Create(const SystemSettings& settings = {}, JobSystem* jobs = nullptr,
                                                         MemoryResource* memory = nullptr);
    FULCRUM_WORLD_MEMORY
    ~PhysicsSystem();
    PhysicsSystem(const PhysicsSystem&) = delete;
    PhysicsSystem& operator=(const PhysicsSystem&) = delete;

    // Advances the world by dt seconds, 0..1; less than a nanosecond has no effect. Errors: NonFinite, OutOfRange; then
    // nothing has changed.
    Status Update(double dt);

    // Puts the trees in order by which steps and queries find bodies, on the job system: after many bodies were
    // created, as when a level is loaded. Else the first query does so, and steps as soon as their own searches have
    // cost as much. Results are the same without.
    void Optimize() const;

    BodyInterface& Bodies() { return bodies_; }
    const BodyInterface& Bodies() const { return bodies_; }
    // The same bodies, by getters that lock the world: for threads that run beside a step.
    BodyInterface& LockingBodies() { return lockingBodies_; }
    const BodyInterface& LockingBodies() const { return lockingBodies_; }
    JointInterface& Joints() { return joints_; }
    const JointInterface& Joints() const { return joints_; }
    const QueryInterface& Queries() const { return queries_; }
    // Keeps all other threads from reading, changing and stepping the world as long as the object lives: they see all
    // changes that this thread makes meanwhile, or none. Each of these is cheaper, too. Waits for a step to end.
    [[nodiscard]] WorldLock::Exclusive HoldForChanges();
    const StepReport& Report() const;
    // Events of the last step: contacts, bodies, broken joints, as enabled in Settings().events. Valid until the next
    // step. Must not be called from callbacks of a step: that is reported (Misuse.h), and the events are empty.
    const StepEvents& Events() const;
    // Events of sensors in the last step, sorted by sensor, time, body. Valid until the next step.
    std::span<const SensorEvent> SensorEvents() const;
    // The bodies inside a sensor at the end of the last step, sorted; bodies removed since then are included. Valid
    // until the next step or the creation of a sensor. Empty if the body is no sensor.
    std::span<const BodyId> BodiesInside(BodyId sensor) const;
    const SystemSettings& Settings() const;
    // Errors as for Create. Takes effect at the next step. If layerCollides changes, contacts that it forbids end, new
    // ones are searched for, and the bodies of these layers wake. If gravity changes, the bodies that it acts on wake;
    // if sleep is no longer enabled, all do.
    Status SetSettings(const SystemSettings& settings);
    // Sets the contact listener (not owned, must outlive its use); null: none. Existing pairs are checked again, and
    // bodies wake whose contact it forbids, or the one before had changed.
    void SetContactListener(const ContactListener* listener);

    // The observer of steps and their stages from now on (not owned, must outlive its use); null: none. Not part of
    // snapshots.
    void SetStepObserver(StepObserver* observer);
    // The observer of calls that change the world, likewise.
    void SetCallObserver(CallObserver* observer);

    // The whole state as bytes, from which steps go on with the same bits: `bytes` are overwritten, and allocated anew
    // only where they do not suffice. Shapes, group filters and what joints of one's own are made of are named, not
    // contained. Error: Unsupported (a body's mutable compound has a custom child); `bytes` are empty then.
    Status SaveSnapshot(std::vector<std::byte>& bytes) const;
    // Restores a snapshot of this world, or of another one: settings, bodies, joints and their ids become those of the
    // snapshot. Report() stays that of the last step. Errors, which leave the world unchanged: Unsupported (not a
    // snapshot; another version or build; a contact listener is set now but was not then, or vice versa), Degenerate
    // (damaged), UnknownId (a referenced object is neither in the world nor in `sources`). Deliberately forged data are
    // not detected: load only trusted data.
    Status RestoreSnapshot(std::span<const std::byte> bytes, const SnapshotSources& sources = {});
    // Saves only some bodies and the joints between them: poses, velocities, forces for the next step, sleep timers;
    // impulses, limits and motors of joints. Error: UnknownId.
    Status SaveBodies(std::span<const BodyId> bodies, std::vector<std::byte>& bytes) const;
    // Restores them, awake; everything else is unchanged. Contacts begin anew, as after SetPose, so later steps are not
    // bit-identical to the original ones. Errors, which leave the world unchanged: Unsupported and Degenerate as above;
    // UnknownId (one of the bodies or joints does not exist); Unsupported also if a body has another shape or a joint
    // another type than when saved.
    Status RestoreBodies(std::span<const std::byte> bytes);
    // 64-bit hash of the whole state except user data: if it is equal, the same calls give the same bits from now on.
    // Independent of the number of threads and lanes. 0 if called from callbacks of a step.
    uint64_t HashState() const;

    // Visits all bodies, in the order of their indices.
    void VisitBodies(FunctionRef<void(BodyId)> visit) const;
    // Visits all awake contacts with at least one point, as solved in the last step, in a deterministic order. Includes
    // speculative contacts.
    void VisitContacts(FunctionRef<void(const ContactView&)> visit) const;
    // The contacts of one body, by pair; none for an unknown id.
    void VisitContactsOf(BodyId body, FunctionRef<void(const ContactView&)> visit) const;
    // Calls visit(id, island) for each dynamic body; islands are numbered from 0 in the order of their smallest body
    // index. Computed by this call: for viewers and tests.
    void VisitIslands(FunctionRef<void(BodyId, uint32_t island)> visit) const;
    // All islands that the last step solved with more than the settings' effort, of which the report lists four: what
    // it was, and for whom. In a deterministic order.
    void VisitEfforts(FunctionRef<void(const IslandEffortReport&)> visit) const;
    // Kinetic plus gravitational potential energy of the dynamic bodies, J; the potential is zero at the world's
    // origin.
    double GetEnergy() const;
    // FNV-1a, 64 bits, of all bodies' poses (position, rotation x y z w as doubles) in the order of their indices.
    uint64_t HashPoses() const;
    // Bytes allocated by the system, all buffers included.
    size_t MemoryUsed() const;

private:
    PhysicsSystem(std::unique_ptr<WorldState> world, std::unique_ptr<StepState> step);
    std::unique_ptr<WorldState> world_;
    std::unique_ptr<StepState> step_;
    std::unique_ptr<SnapshotRoom> snapshots_;
    BodyInterface bodies_, lockingBodies_;
    JointInterface joints_;
    QueryInterface queries_;
};

}  // namespace fulcrum
