#include <Fulcrum/Constraints/Joints/JointTree.h>

#include <Fulcrum/Constraints/BodyLanes.h>

namespace fulcrum {

namespace {

using Vector6 = JointTreeSlot::Vector6;
using Matrix6 = JointTreeSlot::Matrix6;
using Batch = JointBatch<kLanes>;
constexpr double kAnchorCompliance = 1e-5;  // of that of its body

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

// Calls f(part, number of its rows) for the parts of a batch in the order of RowsOf.
template <class AnyBatch, class F>
void VisitParts(AnyBatch& batch, F&& f) {
    if (batch.linear == LinearLock::Point) f(batch.point, 3);
    if (batch.linear == LinearLock::Line) f(batch.line, 2);
    if (batch.angular == AngularLock::All) f(batch.rotation, 3);
    if (batch.angular == AngularLock::Axis) f(batch.hinge, 2);
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
        auto total = part.GetTotalLambda();
        const int i = static_cast<int>(lane);
        for (int k = 0; k < count; ++k, ++row)
            total[k].Set(i, static_cast<float>(static_cast<double>(total[k][i]) + impulses[row]));
        part.SetTotalLambda(total);
    });
}

Vector6 VelocityOf(const BodyState& state) {
    Vector6 v;
    for (int k = 0; k < 3; ++k) {
        v[k] = static_cast<double>(state.linearVelocity[k]);
        v[3 + k] = static_cast<double>(state.angularVelocity[k]);
    }
    return v;
}

// y = A x and y += A^T x, over the first `rows` rows, summed in a fixed order.
Vector6 Times(const Matrix6& a, const Vector6& x, int rows = 6) {
    Vector6 y = Vector6::Zero();
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < 6; ++k) y[i] += a(i, k) * x[k];
    return y;
}
void AddTransposed(Vector6& y, const Matrix6& a, const Vector6& x, int rows) {
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < 6; ++k) y[k] += a(i, k) * x[i];
}

// The inverse of the leading n x n block, symmetric and positive, by Cholesky; rows without a pivot get zeros.
Matrix6 Inverse(const Matrix6& m, int n) {
    Matrix6 l = Matrix6::Zero();
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            double sum = m(i, j);
            for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
            if (j < i) l(i, j) = l(j, j) > 0 ? sum / l(j, j) : 0.0;
            else l(i, i) = sum > 1e-13 * m(i, i) ? std::sqrt(sum) : 0.0;
        }
    Matrix6 inverse = Matrix6::Zero();
    for (int c = 0; c < n; ++c) {
        double x[6];
        for (int i = 0; i < n; ++i) {
            double sum = i == c ? 1.0 : 0.0;
            for (int k = 0; k < i; ++k) sum -= l(i, k) * x[k];
            x[i] = l(i, i) > 0 ? sum / l(i, i) : 0.0;
        }
        for (int i = n - 1; i >= 0; --i) {
            double sum = x[i];
            for (int k = i + 1; k < n; ++k) sum -= l(k, i) * x[k];
            x[i] = l(i, i) > 0 ? sum / l(i, i) : 0.0;
        }
        for (int i = 0; i < n; ++i) inverse(i, c) = x[i];
    }
    return inverse;
}

// a b^T over the first `rows` rows of both.
Matrix6 TimesTransposed(const Matrix6& a, const Matrix6& b, int rowsA, int rowsB) {
    Matrix6 c = Matrix6::Zero();
    for (int i = 0; i < rowsA; ++i)
        for (int j = 0; j < rowsB; ++j)
            for (int k = 0; k < 6; ++k) c(i, j) += a(i, k) * b(j, k);
    return c;
}

// m += j^T s j, j with `rows` rows.
void AddSquare(Matrix6& m, const Matrix6& j, const Matrix6& s, int rows) {
    Matrix6 sj = Matrix6::Zero();
    for (int i = 0; i < rows; ++i)
        for (int k = 0; k < rows; ++k)
            for (int c = 0; c < 6; ++c) sj(i, c) += s(i, k) * j(k, c);
    for (int i = 0; i < rows; ++i)
        for (int r = 0; r < 6; ++r)
            for (int c = 0; c < 6; ++c) m(r, c) += j(i, r) * sj(i, c);
}

Matrix6 MassOf(const BodyMass& body) {
    const float* i = body.inverseInertia;
    Matrix6 inverse = Matrix6::Zero();
    const int places[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 0}, {2, 0}, {2, 1}};
    for (int k = 0; k < 6; ++k)
        inverse(places[k][0], places[k][1]) = inverse(places[k][1], places[k][0]) = static_cast<double>(i[k]);
    const Matrix6 inertia = Inverse(inverse, 3);
    Matrix6 mass = Matrix6::Zero();
    for (int r = 0; r < 3; ++r) {
        mass(r, r) = 1.0 / static_cast<double>(body.inverseMass);
        for (int c = 0; c < 3; ++c) mass(3 + r, 3 + c) = inertia(r, c);
    }
    return mass;
}

}  // namespace

void FactorizeTree(const JointTree& tree, const JointBatch<kLanes>* batches, const BodyMass* masses) {
    for (JointTreeSlot& slot : tree.slots) {
        if (!slot.still) slot.mass = MassOf(masses[slot.body]);
        if (slot.parent == JointTreeSlot::kNone) continue;
        const Rows rows = RowsOf(batches[slot.place.batch], slot.place.lane);
        slot.rows = rows.count;
        slot.own = slot.isA ? Matrix6(-rows.a) : rows.b;
        slot.other = slot.isA ? rows.b : Matrix6(-rows.a);
    }
    for (JointTreeAnchor& anchor : tree.anchors) {
        const Rows rows = RowsOf(batches[anchor.place.batch], anchor.place.lane);
        anchor.rows = rows.count;
        anchor.own = anchor.isA ? Matrix6(-rows.a) : rows.b;
        JointTreeSlot& slot = tree.slots[anchor.slot];
        const double inverseMass = static_cast<double>(masses[slot.body].inverseMass);
        anchor.stiffness = 1.0 / (kAnchorCompliance * inverseMass);
        AddSquare(slot.mass, anchor.own, Matrix6(Matrix6::Identity() * anchor.stiffness), anchor.rows);
    }
    for (size_t s = tree.slots.size(); s-- > 0;) {
        JointTreeSlot& slot = tree.slots[s];
        slot.inverse = slot.still ? Matrix6(Matrix6::Zero()) : Inverse(slot.mass, 6);
        if (slot.parent == JointTreeSlot::kNone) continue;
        slot.response = TimesTransposed(slot.inverse, slot.own, 6, slot.rows);
        Matrix6 compliance = Matrix6::Zero();
        for (int i = 0; i < slot.rows; ++i)
            for (int j = 0; j < slot.rows; ++j)
                for (int k = 0; k < 6; ++k) compliance(i, j) += slot.own(i, k) * slot.response(k, j);
        slot.effectiveMass = Inverse(compliance, slot.rows);
        if (!tree.slots[slot.parent].still)
            AddSquare(tree.slots[slot.parent].mass, slot.other, slot.effectiveMass, slot.rows);
    }
}

void SolveTree(const JointTree& tree, JointBatch<kLanes>* batches, BodyState* states, bool relax) {
    const auto residualOf = [&](const JointPlaceInBatch& place, const Matrix6& own, const Matrix6* other, uint32_t body,
                                uint32_t otherBody, int rows) {
        const Batch& batch = batches[place.batch];
        Vector6 residual = relax ? Vector6(Vector6::Zero()) : Vector6(-BiasOf(batch, place.lane));
        residual -= Times(own, VelocityOf(states[body]), rows);
        if (other) {
            residual -= Times(*other, VelocityOf(states[otherBody]), rows);
        } else {
            // What does not move may be kinematic: its own rows are those of the other side.
            const Rows all = RowsOf(batch, place.lane);
            const bool isA = batch.bodyA[place.lane] == body;
            residual -= Times(isA ? all.b : Matrix6(-all.a), VelocityOf(states[otherBody]), rows);
        }
        return residual;
    };
    for (JointTreeSlot& slot : tree.slots) slot.load = Vector6::Zero();
    for (JointTreeAnchor& anchor : tree.anchors) {
        JointTreeSlot& slot = tree.slots[anchor.slot];
        const Batch& batch = batches[anchor.place.batch];
        const uint32_t still = anchor.isA ? batch.bodyB[anchor.place.lane] : batch.bodyA[anchor.place.lane];
        anchor.residual = residualOf(anchor.place, anchor.own, nullptr, slot.body, still, anchor.rows);
        AddTransposed(slot.load, anchor.own, Vector6(anchor.residual * anchor.stiffness), anchor.rows);
    }
    for (size_t s = tree.slots.size(); s-- > 0;) {
        JointTreeSlot& slot = tree.slots[s];
        slot.velocityChange = Times(slot.inverse, slot.load);
        if (slot.parent == JointTreeSlot::kNone) continue;
        JointTreeSlot& parent = tree.slots[slot.parent];
        slot.residual = residualOf(slot.place, slot.own, &slot.other, slot.body, parent.body, slot.rows) -
                        Times(slot.own, slot.velocityChange, slot.rows);
        AddTransposed(parent.load, slot.other, Times(slot.effectiveMass, slot.residual, slot.rows), slot.rows);
    }
    // `velocityChange` becomes the change of velocity. Blocks of fewer rows have zeros beyond them.
    for (JointTreeSlot& slot : tree.slots) {
        if (slot.parent != JointTreeSlot::kNone) {
            const Vector6 impulse =
                Times(slot.effectiveMass,
                      Vector6(slot.residual - Times(slot.other, tree.slots[slot.parent].velocityChange, slot.rows)),
                      slot.rows);
            slot.velocityChange += Times(slot.response, impulse);
            AddImpulses(batches[slot.place.batch], slot.place.lane, impulse);
        }
        if (slot.still) continue;
        BodyState& state = states[slot.body];
        for (int k = 0; k < 3; ++k) {
            state.linearVelocity[k] += static_cast<float>(slot.velocityChange[k]);
            state.angularVelocity[k] += static_cast<float>(slot.velocityChange[3 + k]);
        }
    }
    for (JointTreeAnchor& anchor : tree.anchors) {
        const Vector6 left = anchor.residual - Times(anchor.own, tree.slots[anchor.slot].velocityChange, anchor.rows);
        AddImpulses(batches[anchor.place.batch], anchor.place.lane, Vector6(left * anchor.stiffness));
    }
}

}  // namespace fulcrum
