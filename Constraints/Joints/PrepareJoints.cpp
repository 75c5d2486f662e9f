#include <Fulcrum/Constraints/Joints/JointDrives.h>
#include <Fulcrum/Constraints/Joints/JointKernels.h>
#include <Fulcrum/Constraints/Joints/JointStrain.h>
#include <Fulcrum/Constraints/Joints/RowErrors.h>
#include <Fulcrum/Constraints/Parts/SpringSoftness.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace fulcrum {

namespace {

using namespace joints;

template <class Real>
Vec3<Real> Column(const Quat<Real>& rotation, const Real& index) {
    const Mat3<Real> m = ToMatrix(rotation);
    Vec3<Real> column;
    for (int k = 0; k < 3; ++k)
        column[k] = Select(index < Real(0.5f), m.x[k], Select(index < Real(1.5f), m.y[k], m.z[k]));
    return column;
}

Vector3 FiniteOrZero(const Vector3& v) { return IsFinite(v) ? v : Vector3(Vector3::Zero()); }

template <int N>
void SetLane(Vec3<Wide<N>>& v, int lane, const Vector3& value) {
    for (int k = 0; k < 3; ++k) v[k].Set(lane, value[k]);
}

template <int N>
void SetLane(RowJacobian<Wide<N>>& lanes, int lane, const RowJacobian<float>& j) {
    SetLane(lanes.a.linear, lane, j.a.linear);
    SetLane(lanes.a.angular, lane, j.a.angular);
    SetLane(lanes.b.linear, lane, j.b.linear);
    SetLane(lanes.b.angular, lane, j.b.angular);
}

// Makes a lane one without a row.
template <int N>
void ClearLane(JointRows<N>& rows, int lane) {
    for (Wide<N>* x : {&rows.startError,
                       &rows.error,
                       &rows.speed,
                       &rows.earlier,
                       &rows.lowest,
                       &rows.highest,
                       &rows.softness.massScale,
                       &rows.softness.impulseScale,
                       &rows.pushRate,
                       &rows.mostPush,
                       &rows.speedPart,
                       &rows.openAbove,
                       &rows.gapRate,
                       &rows.openSoftness.massScale,
                       &rows.openSoftness.impulseScale,
                       &rows.turnsWithA,
                       &rows.radial,
                       &rows.across,
                       &rows.between,
                       &rows.isLock})
        x->Set(lane, 0.0f);
    rows.slot[lane] = 0xFF;
    rows.hold[lane] = RowHold::Nothing;
}

// Sets what does not depend on the mass, for a row whose error is corrected like that of locks.
template <int N>
void SetHard(JointRows<N>& rows, int lane, const JointSolveSettings& s) {
    rows.softness.massScale.Set(lane, 1.0f);
    rows.softness.impulseScale.Set(lane, 0.0f);
    rows.mostPush.Set(lane, s.maxPushSpeed);
}

// Sets everything of a lane's row that does not depend on the effective mass, which is set up with the locks. Jacobian
// and impulse are written by the caller.
template <int N>
void FillLane(JointRows<N>& rows, int lane, const JointRow& row, float previousImpulse, const JointSolveSettings& s,
              RowJacobian<Wide<N>>& jacobian, Wide<N>& impulse) {
    ClearLane(rows, lane);
    if (!std::isfinite(row.error) || !std::isfinite(row.speed)) return;
    SetLane(jacobian, lane, row.jacobian);
    rows.slot[lane] = row.slot;

    using Kind = JointRow::Kind;
    const bool oneSided = row.kind == Kind::AtLeast || row.kind == Kind::SpringAtLeast;
    const float unlimited = JointRow::kUnlimited;
    const float lowest = Max(row.minForce * s.substepDt, oneSided ? 0.0f : -unlimited),
                highest = row.maxForce * s.substepDt;
    const bool hard = row.kind == Kind::Equal || row.kind == Kind::AtLeast;
    rows.startError.Set(lane, row.error);
    rows.error.Set(lane, row.error);
    rows.speed.Set(lane, row.kind == Kind::Speed ? row.speed : 0.0f);
    if (hard) {
        SetHard(rows, lane, s);
        // A motor works no more than its force allows: a correction of the poses would, where it is too weak.
        const bool isWeak = row.minForce > -unlimited || row.maxForce < unlimited;
        if (row.kind == Kind::Equal && isWeak) {
            rows.pushRate.Set(lane, s.baumgarte * s.inverseDt);
            rows.gapRate.Set(lane, s.inverseDt);
        }
    } else {
        rows.softness.massScale.Set(lane, 1.0f);
        rows.mostPush.Set(lane, unlimited);
    }
    rows.openAbove.Set(lane, oneSided ? 0.0f : unlimited);
    rows.openSoftness.massScale.Set(lane, 1.0f);
    if (oneSided) rows.gapRate.Set(lane, s.inverseDt);
    rows.lowest.Set(lane, lowest);
    rows.highest.Set(lane, highest);
    rows.turnsWithA.Set(lane, row.turnsWithA ? 1.0f : 0.0f);
    rows.radial.Set(lane, row.radial ? 1.0f : 0.0f);
    rows.across.Set(lane, row.pivot == JointRow::Pivot::Across ? 1.0f : 0.0f);
    rows.between.Set(lane, row.pivot == JointRow::Pivot::Between ? 1.0f : 0.0f);
    SetLane(rows.ofA, lane, row.ofA);
    SetLane(rows.ofB, lane, row.ofB);
    if (hard) rows.hold[lane] = IsAngle(row) ? RowHold::Angle : RowHold::Distance;
    rows.isLock.Set(lane, row.isLock ? 1.0f : 0.0f);
    if (std::isfinite(previousImpulse)) impulse.Set(lane, Clamp(previousImpulse * s.impulseScale, lowest, highest));
}

// The springs that act on a body along the same way as this row, at most: with w the row's unit direction of motion, by
// masses, the sum of |w . w'| over the springs of the joint, and 1 for each neighbor.
template <int N>
float CoupledSprings(const JointBatch<N>& batch, const JointRowList& list, uint32_t index, int lane) {
    using Kind = JointRow::Kind;
    const auto& part = batch.rows[index].part;
    const RowJacobian<float>& j = list.rows[index].jacobian;
    const float mass = part.GetEffectiveMass()[lane];
    float sum = 1.0f + static_cast<float>(batch.neighbors[lane]);
    for (uint32_t i = 0; i < list.count; ++i) {
        const JointRow& row = list.rows[i];
        if (i == index || (row.kind != Kind::Spring && row.kind != Kind::SpringAtLeast)) continue;
        const auto& other = batch.rows[i].part;
        const Twist<Wide<N>>&a = other.GetResponse().a, &b = other.GetResponse().b;
        float motion = 0.0f;
        for (int k = 0; k < 3; ++k)
            motion += (j.b.linear[k] * b.linear[k][lane] + j.b.angular[k] * b.angular[k][lane]) -
                      (j.a.linear[k] * a.linear[k][lane] + j.a.angular[k] * a.angular[k][lane]);
        sum += Min(Abs(motion) * Sqrt(mass * other.GetEffectiveMass()[lane]), 1.0f);
    }
    return sum;
}

// Sets springs up; the masses must be known. Springs are not relaxed, since their bias is their force.
template <int N>
void SoftenLane(JointBatch<N>& batch, const JointRowList& list, uint32_t index, int lane, const JointSolveSettings& s) {
    using Kind = JointRow::Kind;
    JointRows<N>& rows = batch.rows[index];
    const JointRow& row = list.rows[index];
    if (rows.slot[lane] == 0xFF || (row.kind != Kind::Spring && row.kind != Kind::SpringAtLeast)) return;
    const float mass = rows.part.GetEffectiveMass()[lane];
    SpringConstants<float> constants = ToConstants(row.spring);
    // Limited to the stiffest spring that a substep can resolve.
    if (!(constants.squaredFrequency > 0.0f || constants.stiffness > 0.0f))
        constants = FrequencyConstants(0.25f * s.inverseDt, 1.0f);
    // The stiffness does not change where a path curves and B must rotate along: that would add energy. Where the curve
    // is so tight that it nearly locks the row, rounding may deactivate it in this substep but not in the next.
    if (batch.lockRowCount > 0 && batch.rows[0].isLock[lane] > 0.5f) {
        constexpr float kLeast = 1e-5f;  // as in RowPart::SetResponse
        const float lighter = mass > 0.0f ? Max(rows.freeMass[lane] / mass, kLeast) : kLeast;
        constants.squaredFrequency *= lighter;
        constants.decayRate *= lighter;
    }
    const auto spring = SpringSoftnessOf<float>(s.substepDt, mass > 0.0f ? 1.0f / mass : 0.0f, constants,
                                                CoupledSprings(batch, list, index, lane));
    rows.softness.massScale.Set(lane, spring.softness.massScale);
    rows.softness.impulseScale.Set(lane, spring.softness.impulseScale);
    rows.pushRate.Set(lane, spring.errorRate);
    rows.speedPart.Set(lane, spring.speedPart);
    batch.springs |= spring.speedPart != 0.0f;
    rows.openSoftness.massScale.Set(lane, 0.0f);
    rows.openSoftness.impulseScale.Set(lane, 1.0f);
}

// Collects the rows of the types and distributes them to the lanes. The parts must be set up.
template <LinearLock kLinear, AngularLock kAngular, int N>
void FillRows(JointBatch<N>& batch, const JointRecord* records, JointType* const* types,
              const ConstSolverBodies& bodies, const JointSolveSettings& settings) {
    batch.rowCount = batch.lockRowCount = 0;
    batch.rowsTurnWithA = batch.radial = batch.pivots = batch.springs = false;
    batch.wayA = batch.wayB = {};
    if (batch.rowRoom == 0) return;
    JointRowList lists[N];
    for (int lane = 0; lane < batch.count; ++lane) {
        if (types[batch.joint[lane]]->MaxRows() == 0) continue;  // this joint has no rows, others of the batch do
        const JointRecord& record = records[batch.joint[lane]];
        const auto velocityOf = [&](uint32_t body) {
            const BodyState& state = bodies.states[body];
            const float(&v)[3] = state.linearVelocity, (&w)[3] = state.angularVelocity;
            return Twist<float>{Vector3(v[0], v[1], v[2]), Vector3(w[0], w[1], w[2])};
        };
        const auto frameOf = [&](uint32_t body, const float* f) {
            const float* q = bodies.poses[body].rotation;
            return Quaternion{q[0], q[1], q[2], q[3]} * Quaternion{f[0], f[1], f[2], f[3]};
        };
        JointPose pose;
        pose.armA = LaneOf<N>(batch.startArmA, lane);
        pose.armB = LaneOf<N>(batch.startArmB, lane);
        pose.offset = LaneOf<N>(batch.startOffset, lane);
        pose.frameA = frameOf(batch.bodyA[lane], record.frameA);
        pose.frameB = frameOf(batch.bodyB[lane], record.frameB);
        pose.velocityA = velocityOf(batch.bodyA[lane]);
        pose.velocityB = velocityOf(batch.bodyB[lane]);
        pose.turnedA = FiniteOrZero(types[batch.joint[lane]]->turnedA);
        pose.turnedB = FiniteOrZero(types[batch.joint[lane]]->turnedB);
        pose.dt = settings.dt;
        pose.substepDt = settings.substepDt;
        pose.isDirect = settings.isDirect;
        const BodyPose& a = bodies.poses[batch.bodyA[lane]];
        pose.anchorA = Position(a.position[0], a.position[1], a.position[2]) + pose.armA.cast<double>();
        types[batch.joint[lane]]->quiet = {};
        types[batch.joint[lane]]->CollectRows(pose, lists[lane]);
        FULCRUM_ASSERT(lists[lane].count <= batch.rowRoom);
        lists[lane].count = std::min(lists[lane].count, batch.rowRoom);  // of a type that adds more than its MaxRows
        if (lists[lane].count > batch.rowCount) batch.rowCount = lists[lane].count;
    }
    if (batch.rowCount == 0) return;
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        JointRows<N>& rows = batch.rows[i];
        RowJacobian<Wide<N>> jacobian;
        Wide<N> impulse(0.0f);
        for (int lane = 0; lane < N; ++lane) {
            const JointRowList& list = lists[lane];
            if (i >= list.count) {
                ClearLane(rows, lane);
                continue;
            }
            FillLane(rows, lane, list.rows[i], types[batch.joint[lane]]->impulses[list.rows[i].slot], settings,
                     jacobian, impulse);
            batch.rowsTurnWithA |= list.rows[i].turnsWithA;
            batch.radial |= list.rows[i].radial;
            batch.pivots |= list.rows[i].pivot != JointRow::Pivot::None;
            if (list.rows[i].isLock && i < JointRowList::kMostLocks) batch.lockRowCount = i + 1;
        }
        rows.part.SetJacobian(jacobian);
        rows.part.RestoreState({impulse});
    }
    SetUpRows<kLinear, kAngular>(batch);
    for (int lane = 0; lane < batch.count; ++lane) {
        for (uint32_t i = 0; i < lists[lane].count; ++i)
            NoteDrive(batch, lane, lists[lane].rows[i], batch.rows[i].part.GetEffectiveMass()[lane], settings,
                      types[batch.joint[lane]]->quiet);
        for (uint32_t i = 0; i < lists[lane].count; ++i) SoftenLane(batch, lists[lane], i, lane, settings);
    }
}

// Finds the joints that are strained or past their limits, see JointStrain.h.
template <LinearLock kLinear, AngularLock kAngular, int N>
void FindStrained(JointBatch<N>& batch, const JointErrors<Wide<N>>& errors) {
    using Real = Wide<N>;
    batch.strained = batch.pastLimit = 0;
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        const JointRows<N>& row = batch.rows[i];
        const auto isLimit = row.IsCorrected() & (row.openAbove <= Real(0.0f));
        batch.pastLimit |= (isLimit & (row.startError < Real(-kStrain))).ToBits();
    }
    if constexpr (kAngular == AngularLock::None) return;
    const auto squared = [](const auto& error) {
        Real sum(0.0f);
        for (int k = 0; k < error.size(); ++k) sum += error[k] * error[k];
        return sum;
    };
    Real gap(0.0f), angle(0.0f);
    if constexpr (kLinear == LinearLock::Point) gap = squared(errors.point);
    if constexpr (kLinear == LinearLock::Line) gap = squared(errors.line);
    if constexpr (kAngular == AngularLock::All) angle = squared(errors.rotation);
    if constexpr (kAngular == AngularLock::Axis) angle = squared(errors.hinge);
    const auto isLarge = [&](const InverseMass<Real>& mass, const Vec3<Real>& arm) {
        const Sym3<Real>& inertia = mass.inertia;
        return IsStrainedBy<Real>(gap, Dot<Real>(arm, arm), Max(Max(mass.mass.x(), mass.mass.y()), mass.mass.z()),
                                  inertia.xx + inertia.yy + inertia.zz);
    };
    const auto isStrained = isLarge(batch.massA, batch.startArmA) | isLarge(batch.massB, batch.startArmB) |
                            (angle > Real(kStrain * kStrain));
    batch.strained = isStrained.ToBits();
}

}  // namespace

template <int N>
void PrepareJoints(JointBatch<N>& batch, const JointRecord* records, JointType* const* types,
                   const ConstSolverBodies& bodies, const JointSolveSettings& settings, JointFindings& findings) {
    using Real = Wide<N>;
    Real head[8], frames[8], impulses[8];
    GatherRecordRow<N>(batch.joint, records, JointRecord::kAnchors, head);
    GatherRecordRow<N>(batch.joint, records, JointRecord::kFrames, frames);
    GatherImpulses<N>(batch.joint, records, impulses);
    const auto turns = GatherMasses(batch, bodies.masses);
    batch.turns = Select(turns, Real(1.0f), Real(0.0f));
    batch.turning = turns.Any();
    const Vec3<Real> between = GatherOffset<N>(batch.bodyA, batch.bodyB, bodies.poses);
    const Quat<Real> rotationA = GatherRotation<N>(batch.bodyA, bodies.poses),
                     rotationB = GatherRotation<N>(batch.bodyB, bodies.poses);

    JointPlace<Real> place;
    place.armA = WithinReach<Real>(Rotate<Real>(rotationA, VectorAt<JointRecord::kAnchorA>(head)));
    place.armB = WithinReach<Real>(Rotate<Real>(rotationB, VectorAt<JointRecord::kAnchorB>(head)));
    place.offset = WithinReach<Real>(between + place.armB - place.armA);
    const Quat<Real> frameA = rotationA * QuaternionAt<JointRecord::kFrameA>(frames);
    const Quat<Real> frameB = rotationB * QuaternionAt<JointRecord::kFrameB>(frames);
    batch.startArmA = place.armA;
    batch.startArmB = place.armB;
    batch.startOffset = place.offset;
    batch.earlierLinear = batch.earlierAngular = Zero<Real>();
    const Real scale(settings.impulseScale);
    const Vec3<Real> linearImpulse = VectorAt<JointRecord::kForce>(impulses) * scale;
    const Vec3<Real> angularImpulse = VectorAt<JointRecord::kTorque>(impulses) * scale;

    WithLocks(batch.linear, batch.angular, [&](auto linear, auto angular) {
        if constexpr (linear == LinearLock::Line) {
            batch.startLine = place.line = Column<Real>(frameA, head[JointRecord::kLineAxis]);
            batch.startLineNormal = place.lineNormal = PerpendicularTo<Real>(place.line);
        }
        if constexpr (angular == AngularLock::All) {
            batch.inverseInitial = InverseInitialOrientation<Real>(frameA, frameB);
            place.rotationError = RotationVectorOf<Real>(batch.inverseInitial);
        }
        if constexpr (angular == AngularLock::Axis) {
            batch.startAxisA = place.axisA = Column<Real>(frameA, head[JointRecord::kFreeAxis]);
            batch.startAxisB = place.axisB = Column<Real>(frameB, head[JointRecord::kFreeAxis]);
            batch.startNormal = place.normal = PerpendicularTo<Real>(place.axisB);
        }
        const JointErrors<Real> errors = SetUpParts<linear, angular>(batch, place);
        if constexpr (linear == LinearLock::Point) {
            batch.point.RestoreState({linearImpulse});
            NoteLargest<N>(batch.joint, batch.count, Dot<Real>(errors.point, errors.point), findings.linearError,
                           findings.linearJoint);
        }
        if constexpr (linear == LinearLock::Line) {
            const Vec3<Real> n2 = Cross<Real>(place.line, place.lineNormal);
            batch.line.RestoreState(
                {Vec2<Real>(Dot<Real>(linearImpulse, place.lineNormal), Dot<Real>(linearImpulse, n2))});
            NoteLargest<N>(batch.joint, batch.count,
                           errors.line.x() * errors.line.x() + errors.line.y() * errors.line.y(), findings.linearError,
                           findings.linearJoint);
        }
        if constexpr (angular == AngularLock::All) {
            batch.rotation.RestoreState({angularImpulse});
            NoteLargest<N>(batch.joint, batch.count, Dot<Real>(errors.rotation, errors.rotation), findings.angularError,
                           findings.angularJoint);
        }
        if constexpr (angular == AngularLock::Axis) {
            const Vec3<Real> c = Cross<Real>(place.axisB, place.normal);
            batch.hinge.RestoreState(
                {Vec2<Real>(-Dot<Real>(angularImpulse, c), Dot<Real>(angularImpulse, place.normal))});
            NoteLargest<N>(batch.joint, batch.count,
                           errors.hinge.x() * errors.hinge.x() + errors.hinge.y() * errors.hinge.y(),
                           findings.angularError, findings.angularJoint);
        }
        SetUpCoupling<linear, angular>(batch);
        FillRows<linear, angular>(batch, records, types, bodies, settings);
        findings.turning |= batch.turning;
        FindStrained<linear, angular>(batch, errors);
        SetRowBias(batch, bodies.states);
        batch.radialArmA = place.armA;
        batch.radialArmB = place.armB;
        batch.radialOffset = place.offset;
    });
}

namespace {

// The force and torque of the locks' impulses, world axes: the change of velocity of a body B of unit mass and inertia.
template <int N>
struct Wrench {
    Vec3<Wide<N>> force = Zero<Wide<N>>(), torque = Zero<Wide<N>>();

    Wrench(const JointBatch<N>& batch, const LockImpulses<Wide<N>>& impulses) {
        using Real = Wide<N>;
        Sym3<Real> one;
        one.xx = one.yy = one.zz = Real(1.0f);
        const InverseMass<Real> unit(Real(1.0f), one);
        const auto impulseOf = [&](const auto& part, const Vec3<Real>& impulse) {
            auto lambda = part.GetTotalLambda();
            for (int k = 0; k < lambda.size(); ++k) lambda[k] = impulse[k];
            Twist<Real> a, b;
            part.AddImpulse(a, b, unit, unit, lambda, Real(0.0f) < Real(1.0f));
            return b;
        };
        if (batch.linear == LinearLock::Point) force = impulseOf(batch.point, impulses.linear).linear;
        if (batch.linear == LinearLock::Line) force = impulseOf(batch.line, impulses.linear).linear;
        if (batch.angular == AngularLock::All) torque = impulseOf(batch.rotation, impulses.angular).angular;
        if (batch.angular == AngularLock::Axis) torque = impulseOf(batch.hinge, impulses.angular).angular;
    }
};

// The locks' own impulses of the last substep.
template <int N>
LockImpulses<Wide<N>> OwnImpulses(const JointBatch<N>& batch) {
    using Real = Wide<N>;
    const Real zero(0.0f);
    LockImpulses<Real> own;
    if (batch.linear == LinearLock::Point) own.linear = Widened(batch.point.SaveState().totalLambda, zero);
    if (batch.linear == LinearLock::Line) own.linear = Widened(batch.line.SaveState().totalLambda, zero);
    if (batch.angular == AngularLock::All) own.angular = Widened(batch.rotation.SaveState().totalLambda, zero);
    if (batch.angular == AngularLock::Axis) own.angular = Widened(batch.hinge.SaveState().totalLambda, zero);
    return own;
}

// Impulses of all substeps, including the reaction to the rows.
template <int N>
LockImpulses<Wide<N>> StepImpulses(const JointBatch<N>& batch) {
    LockImpulses<Wide<N>> sum = OwnImpulses(batch);
    if (batch.rowCount > 0) {
        AddReaction(sum.linear, batch.reactionLinear);
        AddReaction(sum.angular, batch.reactionAngular);
    }
    sum.linear += batch.earlierLinear;
    sum.angular += batch.earlierAngular;
    return sum;
}

// Writes a wrench times `scale` to a row of the records.
template <int N>
void ScatterWrench(const JointBatch<N>& batch, JointRecord* records, int row, const Wrench<N>& wrench, float scale) {
    using Real = Wide<N>;
    const Real factor(scale);
    Real values[8];
    SetVectorAt<JointRecord::kForce>(values, wrench.force * factor);
    SetVectorAt<JointRecord::kTorque>(values, wrench.torque * factor);
    values[6] = values[7] = Real(0.0f);
    ScatterRecordRow<N>(batch.joint, batch.count, records, row, values);
}

// Rotation of a body in the step, rad.
Vector3 TurnOf(const BodyState& state, bool kinematic, float dt) {
    Vector3 turn;
    for (int k = 0; k < 3; ++k) turn[k] = kinematic ? state.angularVelocity[k] * dt : state.deltaRotation[k];
    return FiniteOrZero(turn);
}

}  // namespace

template <int N>
void StoreJoints(const JointBatch<N>& batch, JointRecord* records, JointType* const* types, const BodyState* states,
                 float dt, float impulseScale) {
    using Real = Wide<N>;
    const float inverse = 1.0f / impulseScale, perSecond = 1.0f / dt;
    const Wrench<N> own(batch, OwnImpulses(batch)), locks(batch, StepImpulses(batch));
    Wrench<N> total = locks;
    Real impulses[JointRowList::kMaxRows];
    RowImpulses(batch, impulses);
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        const JointRows<N>& rows = batch.rows[i];
        const Real impulse = rows.earlier + impulses[i];
        const auto acts = Abs(impulse) > Real(0.0f);
        const Twist<Real>& b = rows.part.GetJacobian().b;
        total.force -= ZeroUnless<Real>(acts, Vec3<Real>(b.linear * -impulse));
        total.torque -=
            ZeroUnless<Real>(acts, Vec3<Real>((b.angular - Cross<Real>(batch.startArmB, b.linear)) * -impulse));
    }
    ScatterWrench(batch, records, JointRecord::kOwn, own, inverse);
    ScatterWrench(batch, records, JointRecord::kLocks, locks, perSecond);
    ScatterWrench(batch, records, JointRecord::kTotal, total, perSecond);
    if (batch.rowRoom == 0) return;
    for (int lane = 0; lane < batch.count; ++lane) {
        JointType* type = types[batch.joint[lane]];
        if (type->MaxRows() == 0) continue;
        type->turnedA = TurnOf(states[batch.bodyA[lane]], batch.kinematicA >> lane & 1u, dt);
        type->turnedB = TurnOf(states[batch.bodyB[lane]], batch.kinematicB >> lane & 1u, dt);
        type->impulses.fill(0.0f);
        type->forces.fill(0.0f);
        for (uint32_t i = 0; i < batch.rowCount; ++i) {
            const JointRows<N>& rows = batch.rows[i];
            const float impulse = rows.part.SaveState().totalLambda[lane] * inverse,
                        force = (rows.earlier[lane] + impulses[i][lane]) * perSecond;
            if (rows.slot[lane] == 0xFF || !std::isfinite(impulse) || !std::isfinite(force)) continue;
            type->impulses[rows.slot[lane]] = impulse;
            type->forces[rows.slot[lane]] = force;
        }
    }
}

template <int N>
void NoteRowErrors(const JointBatch<N>& batch, const JointType* const* types, float substepDt,
                   JointFindings& findings) {
    using Real = Wide<N>;
    uint32_t lanes = 0;
    for (uint32_t i = 0; i < batch.rowCount; ++i) {
        const JointRows<N>& rows = batch.rows[i];
        lanes |= ((rows.startError <= rows.openAbove) & (Abs(rows.startError) > Real(0.0f))).ToBits();
    }
    const auto note = [](uint32_t joint, float error, float& largest, uint32_t& which) {
        if (!(error > 0.0f) || error < largest || (error == largest && joint >= which)) return;
        largest = error;
        which = joint;
    };
    const float perSubstep = 1.0f / substepDt;
    for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        const uint32_t joint = batch.joint[lane];
        RowErrors errors;
        for (uint32_t i = 0; i < batch.rowCount; ++i) {
            const JointRows<N>& rows = batch.rows[i];
            const float error = rows.startError[lane];
            if (rows.hold[lane] == RowHold::Nothing || error > rows.openAbove[lane]) continue;
            const float force = types[joint]->forces[rows.slot[lane]];
            if (!IsAtForceLimit(error, force, rows.lowest[lane] * perSubstep, rows.highest[lane] * perSubstep))
                errors.Add(std::fabs(error), rows.hold[lane] == RowHold::Angle, rows.isLock[lane] > 0.5f);
        }
        const JointError largest = errors.Largest();
        note(joint, largest.distance, findings.linearError, findings.linearJoint);
        note(joint, largest.angle, findings.angularError, findings.angularJoint);
    }
}

#define FULCRUM_INSTANTIATE(lanes)                                                                                   \
    template void PrepareJoints(JointBatch<lanes>&, const JointRecord*, JointType* const*, const ConstSolverBodies&, \
                                const JointSolveSettings&, JointFindings&);                                          \
    template void StoreJoints(const JointBatch<lanes>&, JointRecord*, JointType* const*, const BodyState*, float,    \
                              float);                                                                                \
    template void NoteRowErrors(const JointBatch<lanes>&, const JointType* const*, float, JointFindings&);
FULCRUM_FOR_EACH_WIDTH(FULCRUM_INSTANTIATE)
#undef FULCRUM_INSTANTIATE

}  // namespace fulcrum
