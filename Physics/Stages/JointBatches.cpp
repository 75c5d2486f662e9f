#include <Fulcrum/Physics/Stages/JointBatches.h>

#include <algorithm>

namespace fulcrum {

namespace {

using Entry = ConstraintColoring::Entry;
using Kind = ConstraintColoring::Kind;

// Joints of the same kind may share a batch: same locks, or ball joints (BallBatch.h) of round or other bodies. Joints
// with mass overrides, or of bodies with locked translations, are not solved as ball joints.
enum JointKind : uint32_t { kRoundBall = 9, kBall = 10 };
uint32_t KindOf(uint32_t kind) { return kind >> 8; }
bool IsBall(uint32_t kind) { return KindOf(kind) >= kRoundBall; }

uint32_t KindOf(const BodyStore& bodies, const Joint& joint) {
    const auto isGuided = [&](int side) { return bodies.dynamics[joint.body[side]].LockedTranslations() != 0; };
    if (joint.locks.linear != LinearLock::Point || joint.locks.angular != AngularLock::None || joint.maxRows > 0 ||
        joint.overridesMass || isGuided(0) || isGuided(1))
        return static_cast<uint32_t>(joint.locks.linear) * 3 + static_cast<uint32_t>(joint.locks.angular);
    const auto isRound = [&](int side) {
        const BodyDynamics& d = bodies.dynamics[joint.body[side]];
        return joint.fixed[side] || (d.spherical && !d.LocksRotation());
    };
    return isRound(0) && isRound(1) ? kRoundBall : kBall;
}

// Counts the joints with rows of bodies, and of each joint its neighbors. They are few: bodies with none keep 0.
void CountNeighbors(const ConstraintColoring& coloring, JointStore& joints, SolverLayout& layout) {
    Array<uint32_t>& counts = layout.rowJoints;
    const auto visitBodies = [&](auto&& visit) {
        VisitEntries(coloring, Kind::Joint, [&](uint32_t, const Entry& entry) {
            Joint& joint = joints.joints[entry.constraint];
            if (joint.maxRows == 0) return;
            for (int side = 0; side < 2; ++side)
                if (!joint.fixed[side]) visit(joint, joint.body[side]);
        });
    };
    visitBodies([&](Joint& joint, uint32_t body) {
        if (counts.size() <= body) counts.resize(body + 1, 0);
        ++counts[body];
        joint.neighbors = 0;
    });
    visitBodies([&](Joint& joint, uint32_t body) { joint.neighbors = std::max(joint.neighbors, counts[body] - 1); });
    visitBodies([&](const Joint&, uint32_t body) { counts[body] = 0; });
}

// Updates the layout's list of joints and their order within a color.
void ListJoints(const BodyStore& bodies, const ConstraintColoring& coloring, JointStore& joints, SolverLayout& layout) {
    layout.listedJoints.clear();
    VisitEntries(coloring, Kind::Joint, [&](uint32_t c, const Entry& entry) {
        Joint& joint = joints.joints[entry.constraint];
        joint.locks = joint.type->Locks();
        const uint32_t before = joint.maxRows;
        joint.maxRows = joint.type->MaxRows();
        // Batches without rows do not store row impulses, so those of the last step must be cleared.
        if (joint.maxRows == 0 && before > 0) {
            joint.type->impulses.fill(0.0f);
            joint.type->forces.fill(0.0f);
        }
        JointRecord& record = joints.records[entry.constraint];
        record.lineAxis = joint.locks.line;
        record.freeAxis = joint.locks.axis;
        if (c == ConstraintColoring::kOverflow) return;
        layout.listedJoints.push_back(
            {KindOf(bodies, joint) << 8 | joint.maxRows, entry.constraint, MovingBodyOf(entry), c});
    });
    std::sort(layout.listedJoints.begin(), layout.listedJoints.end());
    CountNeighbors(coloring, joints, layout);
}

// Sets the members shared by all kinds of batches, for at most N joints; remaining lanes repeat the last joint and are
// never written back.
template <class Batch, size_t N>
void FillLanes(const BodyStore& bodies, const JointStore& store, Batch& batch, const uint32_t (&)[N],
               std::span<const SortedJoint> joints) {
    batch.count = static_cast<int32_t>(joints.size());
    batch.fixedA = batch.fixedB = batch.kinematicA = batch.kinematicB = batch.high = 0;
    for (size_t lane = 0; lane < N; ++lane) {
        const uint32_t index = joints[std::min(lane, joints.size() - 1)].joint;
        const Joint& joint = store.joints[index];
        const auto bit = [&](bool set) { return static_cast<uint32_t>(set) << lane; };
        const auto isKinematic = [&](int side) {
            return bodies.dynamics[joint.body[side]].motion == MotionType::Kinematic;
        };
        batch.joint[lane] = index;
        if constexpr (requires { batch.neighbors; }) batch.neighbors[lane] = joint.neighbors;
        batch.bodyA[lane] = joint.body[0];
        batch.bodyB[lane] = joint.body[1];
        batch.fixedA |= bit(joint.fixed[0]);
        batch.fixedB |= bit(joint.fixed[1]);
        batch.kinematicA |= bit(isKinematic(0));
        batch.kinematicB |= bit(isKinematic(1));
        batch.high |= bit(joint.priority == JointPriority::High);
    }
}

template <int N>
void FillBatch(const BodyStore& bodies, const JointStore& store, JointBatch<N>& batch,
               std::span<const SortedJoint> joints) {
    FillLanes(bodies, store, batch, batch.joint, joints);
    batch.rowCount = batch.rowRoom = 0;
    batch.overridesMass = false;
    for (const SortedJoint& sorted : joints) {
        const Joint& joint = store.joints[sorted.joint];
        batch.linear = joint.locks.linear;
        batch.angular = joint.locks.angular;
        batch.rowRoom = std::max(batch.rowRoom, joint.maxRows);
        batch.overridesMass |= joint.overridesMass;
    }
    if (batch.overridesMass)
        for (int lane = 0; lane < N; ++lane) batch.SetMassOverride(lane, store.joints[batch.joint[lane]].massOverride);
}
template <int N>
void FillBatch(const BodyStore& bodies, const JointStore& store, BallBatch<N>& batch,
               std::span<const SortedJoint> joints) {
    FillLanes(bodies, store, batch, batch.joint, joints);
    batch.round = KindOf(joints.front().kind) == kRoundBall;
}

template <class Batch>
Batch& NextBatch(BatchList<Batch>& list) {
    if (list.batches.size() == list.count) list.batches.resize(list.count + list.count / 4 + 1);
    return list.batches[list.count++];
}

template <int N>
void ShareRows(std::span<JointBatch<N>> batches, Array<JointRows<N>>& rows) {
    size_t count = 0;
    for (const JointBatch<N>& batch : batches) count += batch.rowRoom;
    if (rows.size() < count) rows.resize(count + count / 4);
    count = 0;
    for (JointBatch<N>& batch : batches) {
        batch.rows = rows.data() + count;
        count += batch.rowRoom;
    }
}

}  // namespace

std::span<const SortedJoint> SortJoints(const BodyStore& bodies, const ConstraintColoring& coloring,
                                        const Islands& islands, JointStore& joints, SolverLayout& layout,
                                        ScratchArena& scratch) {
    if (layout.jointVersion != coloring.JointVersion()) ListJoints(bodies, coloring, joints, layout);
    layout.jointVersion = coloring.JointVersion();
    const size_t count = layout.listedJoints.size();
    std::span<SortedJoint> placed = scratch.Allocate<SortedJoint>(count), sorted = scratch.Allocate<SortedJoint>(count);
    std::span<uint32_t> next = scratch.Allocate<uint32_t>(size_t(islands.groups) * ConstraintColoring::kColors);
    std::fill(next.begin(), next.end(), 0u);
    for (size_t i = 0; i < count; ++i) {
        const ListedJoint& listed = layout.listedJoints[i];
        placed[i] = {islands.groupOf[bodies.cold[listed.body].awakePlace] * ConstraintColoring::kColors + listed.color,
                     listed.kind, listed.joint};
        ++next[placed[i].place];
    }
    ExclusivePrefixSum(next);
    for (const SortedJoint& joint : placed) sorted[next[joint.place]++] = joint;
    return sorted;
}

void MakeJointBatches(const BodyStore& bodies, const JointStore& joints, uint32_t place,
                      std::span<const SortedJoint>& sorted, SolverLayout& layout, ColorBatches& color) {
    const bool isDirect = layout.groups[place / ConstraintColoring::kColors].isDirect;
    color.of[kJoints].begin = layout.joints.count;
    color.of[kBalls].begin = layout.balls.count;
    while (!sorted.empty() && sorted.front().place == place) {
        size_t n = 1;
        while (n < kLanes && n < sorted.size() && sorted[n].place == place &&
               KindOf(sorted[n].kind) == KindOf(sorted[0].kind))
            ++n;
        if (IsBall(sorted.front().kind) && !isDirect)
            FillBatch(bodies, joints, NextBatch(layout.balls), sorted.first(n));
        else FillBatch(bodies, joints, NextBatch(layout.joints), sorted.first(n));
        sorted = sorted.subspan(n);
    }
    color.of[kJoints].end = layout.joints.count;
    color.of[kBalls].end = layout.balls.count;
}

void MakeOverflowJoints(const BodyStore& bodies, const JointStore& joints, const ConstraintColoring& coloring,
                        Array<JointBatch<1>>& batches) {
    const Array<Entry>& overflow = coloring.At(ConstraintColoring::kOverflow).Of(Kind::Joint);
    batches.resize(overflow.size());
    for (size_t i = 0; i < batches.size(); ++i) {
        const SortedJoint joint{0, 0, overflow[i].constraint};
        FillBatch(bodies, joints, batches[i], std::span(&joint, 1));
    }
}

void ShareRows(SolverLayout& layout) {
    ShareRows(std::span(layout.joints.batches).first(layout.joints.count), layout.jointRows);
    ShareRows(std::span(layout.overflowJoints), layout.overflowRows);
}

}  // namespace fulcrum
