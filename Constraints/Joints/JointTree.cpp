#include <Fulcrum/Constraints/Joints/JointTree.h>

#include <Fulcrum/Constraints/BodyLanes.h>

#include <cmath>
#include <type_traits>

namespace fulcrum {

namespace {

using Vector = Vec3<double>;
using Vector6 = JointTreeBlock::Vector6;
using Matrix6 = JointTreeBlock::Matrix6;
using Batch = JointBatch<kLanes>;
constexpr uint32_t kNone = JointTreeSlot::kNone;
constexpr double kAnchorCompliance = 1e-5;  // relative to the compliance of its body
constexpr double kSmallestPivot = 1e-13;    // relative to the diagonal: smaller pivots are rounding errors

Vector ToDouble(const float (&v)[3]) {
    return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}
template <class Lanes>
Vector LaneInDouble(const Vec3<Lanes>& v, uint32_t lane) {
    const int i = static_cast<int>(lane);
    return {static_cast<double>(v.x()[i]), static_cast<double>(v.y()[i]), static_cast<double>(v.z()[i])};
}

// ---- Rows of any locks ----

// Calls f(part, number of its rows) for the parts of a batch in the order of RowsOf.
template <class AnyBatch, class F>
void VisitParts(AnyBatch& batch, F&& f) {
    if (batch.linear == LinearLock::Point) f(batch.point, 3);
    if (batch.linear == LinearLock::Line) f(batch.line, 2);
    if (batch.angular == AngularLock::All) f(batch.rotation, 3);
    if (batch.angular == AngularLock::Axis) f(batch.hinge, 2);
}

// Rows of a joint's locks: J = [-a, b].
struct Rows {
    Matrix6 a = Matrix6::Zero(), b = Matrix6::Zero();
    int count = 0;

    void Add(const RowJacobian<float>& j) {
        Add(a, j.a);
        Add(b, j.b);
        ++count;
    }

private:
    void Add(Matrix6& to, const Twist<float>& j) const {
        for (int k = 0; k < 3; ++k) {
            to(count, k) = static_cast<double>(j.linear[k]);
            to(count, 3 + k) = static_cast<double>(j.angular[k]);
        }
    }
};

Rows RowsOf(const Batch& batch, uint32_t lane) {
    Rows rows;
    if (batch.linear == LinearLock::Point)
        for (int k = 0; k < 3; ++k)
            rows.Add(AxisJacobian<float>({LaneOf<kLanes>(batch.point.GetArm1(), lane),
                                          LaneOf<kLanes>(batch.point.GetArm2(), lane), Vector3::Unit(k)}));
    if (batch.linear == LinearLock::Line) {
        const auto& frame = batch.line.GetFrame();
        for (const auto* axis : {&frame.axis1, &frame.axis2})
            rows.Add(AxisJacobian<float>(
                {LaneOf<kLanes>(frame.r1PlusU, lane), LaneOf<kLanes>(frame.r2, lane), LaneOf<kLanes>(*axis, lane)}));
    }
    if (batch.angular == AngularLock::All)
        for (int k = 0; k < 3; ++k) rows.Add(AngleJacobian<float>(Vector3::Unit(k)));
    if (batch.angular == AngularLock::Axis) {
        rows.Add(AngleJacobian<float>(-LaneOf<kLanes>(batch.hinge.GetC2(), lane)));
        rows.Add(AngleJacobian<float>(LaneOf<kLanes>(batch.hinge.GetB2(), lane)));
    }
    return rows;
}

Vector6 BiasOf(const Batch& batch, uint32_t lane) {
    Vector6 bias = Vector6::Zero();
    int row = 0;
    VisitParts(batch, [&](const auto& part, int count) {
        for (int k = 0; k < count; ++k) bias[row++] = static_cast<double>(part.GetBias()[k][static_cast<int>(lane)]);
    });
    return bias;
}

void AddImpulses(Batch& batch, uint32_t lane, const Vector6& impulses) {
    int row = 0;
    VisitParts(batch, [&](auto& part, int count) {
        for (int k = 0; k < count; ++k) part.AddTotalLambda(k, static_cast<int>(lane), impulses[row++]);
    });
}

// Transforms rows for motions about the center of mass to rows for motions about `reference`.
void MoveRows(Matrix6& rows, int count, const Vector& reference) {
    for (int i = 0; i < count; ++i) {
        const Vector by = reference.cross(Vector(rows(i, 0), rows(i, 1), rows(i, 2)));
        for (int k = 0; k < 3; ++k) rows(i, 3 + k) -= by[k];
    }
}

// ---- Six numbers; sums in a fixed order ----

Vector6 ToSix(const Twist<double>& t) {
    Vector6 v;
    for (int k = 0; k < 3; ++k) {
        v[k] = t.linear[k];
        v[3 + k] = t.angular[k];
    }
    return v;
}
Twist<double> ToTwist(const Vector6& v) { return {Vector(v[0], v[1], v[2]), Vector(v[3], v[4], v[5])}; }

// y = A x and y += A^T x, over the first `rows` rows.
Vector6 Times(const Matrix6& a, const Vector6& x, int rows = 6) {
    Vector6 y = Vector6::Zero();
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < 6; ++k) y[i] += a(i, k) * x[k];
    return y;
}
void AddTransposed(Twist<double>& y, const Matrix6& a, const Vector6& x, int rows) {
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < 3; ++k) {
            y.linear[k] += a(i, k) * x[i];
            y.angular[k] += a(i, 3 + k) * x[i];
        }
}

// The inverse of the leading block, symmetric and positive, by Cholesky; rows without a pivot get zeros.
template <int n>
Matrix6 Inverse(const Matrix6& m) {
    double l[n][n], inversePivot[n];
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            double sum = m(i, j);
            for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
            if (j < i) l[i][j] = sum * inversePivot[j];
            else inversePivot[i] = sum > kSmallestPivot * m(i, i) ? 1.0 / std::sqrt(sum) : 0.0;
        }
    // L^-1, and L^-T L^-1.
    double inverseL[n][n];
    for (int c = 0; c < n; ++c) {
        inverseL[c][c] = inversePivot[c];
        for (int i = c + 1; i < n; ++i) {
            double sum = 0;
            for (int k = c; k < i; ++k) sum -= l[i][k] * inverseL[k][c];
            inverseL[i][c] = sum * inversePivot[i];
        }
    }
    Matrix6 inverse = Matrix6::Zero();
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            double sum = 0;
            for (int k = i; k < n; ++k) sum += inverseL[k][i] * inverseL[k][j];
            inverse(i, j) = inverse(j, i) = sum;
        }
    return inverse;
}

// ---- Masses ----

Sym3<double> Inverse(const Sym3<double>& k) {
    const auto inversePivot = [](double pivot, double scale) {
        return pivot > kSmallestPivot * scale ? 1.0 / pivot : 0.0;
    };
    const double dx = inversePivot(k.xx, k.xx);
    const double lxy = k.xy * dx, lxz = k.xz * dx;
    const double yz = k.yz - k.xy * lxz;
    const double dy = inversePivot(k.yy - k.xy * lxy, k.yy);
    const double lyz = yz * dy;
    const double dz = inversePivot(k.zz - k.xz * lxz - yz * lyz, k.zz);
    const double corner = lxy * lyz - lxz;  // of L^-1
    Sym3<double> inverse;
    inverse.zz = dz;
    inverse.yz = -(lyz * dz);
    inverse.xz = corner * dz;
    inverse.yy = dy + lyz * lyz * dz;
    inverse.xy = -(lxy * dy + lyz * corner * dz);
    inverse.xx = dx + lxy * lxy * dy + corner * corner * dz;
    return inverse;
}

// m[r]x, the matrix of v -> m (r x v), by columns.
Mat3<double> TimesCross(const Sym3<double>& m, const Vector& r) {
    const Vector x(m.xx, m.xy, m.xz), y(m.xy, m.yy, m.yz), z(m.xz, m.yz, m.zz);
    return {y * r.z() - z * r.y(), z * r.x() - x * r.z(), x * r.y() - y * r.x()};
}

// Adds a point mass of the body: `linear` at `arm` from the reference point.
void AddAt(ArticulatedMass& to, const Sym3<double>& linear, const Vector& arm) {
    to.linear.xx += linear.xx;
    to.linear.yy += linear.yy;
    to.linear.zz += linear.zz;
    to.linear.xy += linear.xy;
    to.linear.xz += linear.xz;
    to.linear.yz += linear.yz;
    const Mat3<double> p = TimesCross(linear, arm);
    to.coupling.x -= p.x;
    to.coupling.y -= p.y;
    to.coupling.z -= p.z;
    // [r]x linear [r]x^T
    to.angular.xx -= arm.y() * p.x.z() - arm.z() * p.x.y();
    to.angular.yy -= arm.z() * p.y.x() - arm.x() * p.y.z();
    to.angular.zz -= arm.x() * p.z.y() - arm.y() * p.z.x();
    to.angular.xy -= arm.y() * p.y.z() - arm.z() * p.y.y();
    to.angular.xz -= arm.y() * p.z.z() - arm.z() * p.z.y();
    to.angular.yz -= arm.z() * p.z.x() - arm.x() * p.z.z();
}

// The mass of a single body about a point that is `reference` from its center of mass.
ArticulatedMass MassOf(const BodyMass& body, const Vector& reference) {
    const float* i = body.inverseInertia;
    Sym3<double> inverse;
    inverse.xx = static_cast<double>(i[0]);
    inverse.yy = static_cast<double>(i[1]);
    inverse.zz = static_cast<double>(i[2]);
    inverse.xy = static_cast<double>(i[3]);
    inverse.xz = static_cast<double>(i[4]);
    inverse.yz = static_cast<double>(i[5]);
    ArticulatedMass mass;
    mass.coupling = {Vector::Zero(), Vector::Zero(), Vector::Zero()};
    mass.angular = Inverse(inverse);
    Sym3<double> linear;
    linear.xx = linear.yy = linear.zz = 1.0 / static_cast<double>(body.inverseMass);
    AddAt(mass, linear, -reference);
    return mass;
}

// to += j^T s j, for `rows` rows.
void AddSquare(ArticulatedMass& to, const Matrix6& j, const Matrix6& s, int rows) {
    Matrix6 sj = Matrix6::Zero();
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < rows; ++k)
            for (int c = 0; c < 6; ++c) sj(i, c) += s(i, k) * j(k, c);
    const auto at = [&](int r, int c) {
        double sum = 0;
        for (int i = 0; i < rows; ++i) sum += j(i, r) * sj(i, c);
        return sum;
    };
    const auto add = [&](Sym3<double>& block, int first) {
        block.xx += at(first, first);
        block.yy += at(first + 1, first + 1);
        block.zz += at(first + 2, first + 2);
        block.xy += at(first, first + 1);
        block.xz += at(first, first + 2);
        block.yz += at(first + 1, first + 2);
    };
    add(to.linear, 0);
    add(to.angular, 3);
    for (int r = 0; r < 3; ++r) {
        to.coupling.x[r] += at(r, 3);
        to.coupling.y[r] += at(r, 4);
        to.coupling.z[r] += at(r, 5);
    }
}

Matrix6 ToMatrix6(const ArticulatedMass& mass) {
    Matrix6 m;
    const auto set = [&](const Sym3<double>& block, int first) {
        m(first, first) = block.xx;
        m(first + 1, first + 1) = block.yy;
        m(first + 2, first + 2) = block.zz;
        m(first, first + 1) = m(first + 1, first) = block.xy;
        m(first, first + 2) = m(first + 2, first) = block.xz;
        m(first + 1, first + 2) = m(first + 2, first + 1) = block.yz;
    };
    set(mass.linear, 0);
    set(mass.angular, 3);
    for (int r = 0; r < 3; ++r) {
        m(r, 3) = m(3, r) = mass.coupling.x[r];
        m(r, 4) = m(4, r) = mass.coupling.y[r];
        m(r, 5) = m(5, r) = mass.coupling.z[r];
    }
    return m;
}

// ---- Slots ----

// Velocity of the body's point at `arm` from its center of mass.
Vector VelocityAt(const BodyState& state, const Vector& arm) {
    return ToDouble(state.linearVelocity) + ToDouble(state.angularVelocity).cross(arm);
}
Vector6 VelocityOf(const BodyState& state, const Vector& reference) {
    return ToSix({VelocityAt(state, reference), ToDouble(state.angularVelocity)});
}

// A ball joint's velocity is that of B minus that of A.
double SignOf(const JointTreeSlot& slot) { return slot.isA ? -1.0 : 1.0; }

void SetUpBall(JointTreeSlot& slot, const JointTreeSlot& parent, const Batch& batch) {
    const Vector a = LaneInDouble(batch.point.GetArm1(), slot.place.lane),
                 b = LaneInDouble(batch.point.GetArm2(), slot.place.lane);
    slot.reference = slot.isA ? a : b;
    slot.parentArm = (slot.isA ? b : a) - parent.reference;
}

void SetUpBlock(JointTreeBlock& block, const JointTreeSlot& slot, const JointTreeSlot& parent, const Batch& batch) {
    const Rows rows = RowsOf(batch, slot.place.lane);
    block.rows = rows.count;
    block.own = slot.isA ? Matrix6(-rows.a) : rows.b;
    block.other = slot.isA ? rows.b : Matrix6(-rows.a);
    MoveRows(block.other, block.rows, parent.reference);
}

void EliminateBall(ArticulatedMass& mass) {
    const Sym3<double> inverse = Inverse(mass.angular);
    const Mat3<double>& b = mass.coupling;
    const Mat3<double> g = {b * Vector(inverse.xx, inverse.xy, inverse.xz),
                            b * Vector(inverse.xy, inverse.yy, inverse.yz),
                            b * Vector(inverse.xz, inverse.yz, inverse.zz)};
    const auto at = [&](int r, int c) { return g.x[r] * b.x[c] + g.y[r] * b.y[c] + g.z[r] * b.z[c]; };
    mass.linear.xx -= at(0, 0);
    mass.linear.yy -= at(1, 1);
    mass.linear.zz -= at(2, 2);
    mass.linear.xy -= at(0, 1);
    mass.linear.xz -= at(0, 2);
    mass.linear.yz -= at(1, 2);
    mass.coupling = g;
    mass.angular = inverse;
}

template <int kRows>
void EliminateBlock(JointTreeBlock& block) {
    Matrix6 compliance = Matrix6::Zero();
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < kRows; ++j) {
            double sum = 0;
            for (int k = 0; k < 6; ++k) sum += block.inverse(i, k) * block.own(j, k);
            block.response(i, j) = sum;
        }
    for (int i = 0; i < kRows; ++i)
        for (int j = 0; j <= i; ++j) {
            double sum = 0;
            for (int k = 0; k < 6; ++k) sum += block.own(i, k) * block.response(k, j);
            compliance(i, j) = compliance(j, i) = sum;
        }
    block.effectiveMass = Inverse<kRows>(compliance);
}
void EliminateBlock(JointTreeBlock& block) {
    switch (block.rows) {
        case 2: EliminateBlock<2>(block); break;
        case 3: EliminateBlock<3>(block); break;
        case 4: EliminateBlock<4>(block); break;
        case 5: EliminateBlock<5>(block); break;
        default: EliminateBlock<6>(block); break;
    }
}

// The impulse of a block's joint, in its rows.
Vector6 ImpulseOf(const JointTreeBlock& block, const Twist<double>& parentChange) {
    return Times(block.effectiveMass, Vector6(block.residual - Times(block.other, ToSix(parentChange), block.rows)),
                 block.rows);
}

}  // namespace

void FactorizeTree(const JointTree& tree, const JointBatch<kLanes>* batches, const BodyMass* masses) {
    for (JointTreeSlot& slot : tree.slots) {
        slot.reference = Vector::Zero();
        if (slot.parent != kNone) {
            const JointTreeSlot& parent = tree.slots[slot.parent];
            const Batch& batch = batches[slot.place.batch];
            if (slot.block == kNone) SetUpBall(slot, parent, batch);
            else SetUpBlock(tree.blocks[slot.block], slot, parent, batch);
        }
        if (!slot.fixed) slot.mass = MassOf(masses[slot.body], slot.reference);
    }
    for (JointTreeAnchor& anchor : tree.anchors) {
        const Rows rows = RowsOf(batches[anchor.place.batch], anchor.place.lane);
        JointTreeSlot& slot = tree.slots[anchor.slot];
        anchor.rows = rows.count;
        anchor.own = anchor.isA ? Matrix6(-rows.a) : rows.b;
        anchor.other = anchor.isA ? rows.b : Matrix6(-rows.a);
        MoveRows(anchor.own, anchor.rows, slot.reference);
        const double inverseMass = static_cast<double>(masses[slot.body].inverseMass);
        anchor.stiffness = 1.0 / (kAnchorCompliance * inverseMass);
        AddSquare(slot.mass, anchor.own, Matrix6(Matrix6::Identity() * anchor.stiffness), anchor.rows);
    }
    for (size_t s = tree.slots.size(); s-- > 0;) {
        JointTreeSlot& slot = tree.slots[s];
        if (slot.fixed) continue;
        if (slot.block == kNone) {
            EliminateBall(slot.mass);
            JointTreeSlot& parent = tree.slots[slot.parent];
            if (!parent.fixed) AddAt(parent.mass, slot.mass.linear, slot.parentArm);
            continue;
        }
        JointTreeBlock& block = tree.blocks[slot.block];
        block.inverse = Inverse<6>(ToMatrix6(slot.mass));
        if (slot.parent == kNone) continue;
        EliminateBlock(block);
        JointTreeSlot& parent = tree.slots[slot.parent];
        if (!parent.fixed) AddSquare(parent.mass, block.other, block.effectiveMass, block.rows);
    }
}

void SolveTree(const JointTree& tree, JointBatch<kLanes>* batches, BodyState* states, bool relax) {
    for (JointTreeSlot& slot : tree.slots) slot.load = {Vector::Zero(), Vector::Zero()};
    for (JointTreeAnchor& anchor : tree.anchors) {
        JointTreeSlot& slot = tree.slots[anchor.slot];
        const Batch& batch = batches[anchor.place.batch];
        const uint32_t lane = anchor.place.lane;
        // The side without mass may be kinematic.
        const uint32_t fixed = anchor.isA ? batch.bodyB[lane] : batch.bodyA[lane];
        anchor.residual = relax ? Vector6(Vector6::Zero()) : Vector6(-BiasOf(batch, lane));
        anchor.residual -= Times(anchor.own, VelocityOf(states[slot.body], slot.reference), anchor.rows);
        anchor.residual -= Times(anchor.other, VelocityOf(states[fixed], Vector::Zero()), anchor.rows);
        AddTransposed(slot.load, anchor.own, Vector6(anchor.residual * anchor.stiffness), anchor.rows);
    }
    for (size_t s = tree.slots.size(); s-- > 0;) {
        JointTreeSlot& slot = tree.slots[s];
        if (slot.block != kNone) {
            JointTreeBlock& block = tree.blocks[slot.block];
            const Vector6 change = Times(block.inverse, ToSix(slot.load));
            slot.change = ToTwist(change);
            if (slot.parent == kNone) continue;
            JointTreeSlot& parent = tree.slots[slot.parent];
            block.residual =
                relax ? Vector6(Vector6::Zero()) : Vector6(-BiasOf(batches[slot.place.batch], slot.place.lane));
            block.residual -= Times(block.own, VelocityOf(states[slot.body], slot.reference), block.rows);
            block.residual -= Times(block.other, VelocityOf(states[parent.body], parent.reference), block.rows);
            block.residual -= Times(block.own, change, block.rows);
            AddTransposed(parent.load, block.other, Times(block.effectiveMass, block.residual, block.rows), block.rows);
        } else if (slot.fixed) {
            slot.change = {Vector::Zero(), Vector::Zero()};
        } else {
            JointTreeSlot& parent = tree.slots[slot.parent];
            slot.speed = VelocityAt(states[parent.body], parent.reference + slot.parentArm) -
                         VelocityAt(states[slot.body], slot.reference);
            if (!relax)
                slot.speed -= LaneInDouble(batches[slot.place.batch].point.GetBias(), slot.place.lane) * SignOf(slot);
            slot.freeTurn = slot.mass.angular * slot.load.angular;
            slot.freeForce = slot.mass.coupling * slot.load.angular - slot.load.linear;
            const Vector force = slot.mass.linear * slot.speed + slot.freeForce;
            parent.load.linear -= force;
            parent.load.angular -= slot.parentArm.cross(force);
        }
    }
    for (JointTreeSlot& slot : tree.slots) {
        if (slot.fixed) continue;
        if (slot.parent != kNone) {
            const Twist<double>& parent = tree.slots[slot.parent].change;
            Batch& batch = batches[slot.place.batch];
            if (slot.block == kNone) {
                slot.change.linear = parent.linear + parent.angular.cross(slot.parentArm) + slot.speed;
                slot.change.angular = slot.freeTurn - slot.mass.coupling.TransposeMultiply(slot.change.linear);
                const Vector impulse = (slot.mass.linear * slot.change.linear + slot.freeForce) * SignOf(slot);
                for (int k = 0; k < 3; ++k)
                    batch.point.AddTotalLambda(k, static_cast<int>(slot.place.lane), impulse[k]);
            } else {
                const JointTreeBlock& block = tree.blocks[slot.block];
                const Vector6 impulse = ImpulseOf(block, parent);
                Vector6 change = ToSix(slot.change);
                for (int i = 0; i < 6; ++i)
                    for (int k = 0; k < block.rows; ++k) change[i] += block.response(i, k) * impulse[k];
                slot.change = ToTwist(change);
                AddImpulses(batch, slot.place.lane, impulse);
            }
        }
        BodyState& state = states[slot.body];
        const Vector linear = slot.change.linear - slot.change.angular.cross(slot.reference);
        for (int k = 0; k < 3; ++k) {
            state.linearVelocity[k] += static_cast<float>(linear[k]);
            state.angularVelocity[k] += static_cast<float>(slot.change.angular[k]);
        }
    }
    for (JointTreeAnchor& anchor : tree.anchors) {
        const Vector6 left = anchor.residual - Times(anchor.own, ToSix(tree.slots[anchor.slot].change), anchor.rows);
        AddImpulses(batches[anchor.place.batch], anchor.place.lane, Vector6(left * anchor.stiffness));
    }
}

}  // namespace fulcrum
