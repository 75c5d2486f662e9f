// The parts (Constraints/Parts) at work in joints, at the default settings: steps of two bodies whose motion a joint
// locks in part, against their closed forms. Iterated, and solved directly as under a load.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <functional>
#include <string>

namespace fulcrum::testing {
namespace {

// Of two bodies: linear and angular of A, then of B.
using Motion = Eigen::Matrix<double, 12, 1>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 12>;
// Which of the six axes of a joint's frame are locked, in the order of JointAxis.
using Locked = std::array<bool, 6>;

Eigen::Vector3d ToDense(const Position& v) { return v; }
Eigen::Vector3d ToDense(const Vector3& v) { return ToDense(v.cast<double>()); }
Eigen::Matrix3d Columns(const Quaternion& q) {
    const Matrix3 m = ToMatrix(q);
    Eigen::Matrix3d columns;
    columns << ToDense(m.x), ToDense(m.y), ToDense(m.z);
    return columns;
}
// r x v as a matrix times v.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& r) {
    Eigen::Matrix3d m;
    m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
    return m;
}

// Two oblique bodies of different masses and three different moments of inertia each, and a joint's frame beside both.
class TwoBodies {
public:
    static constexpr double kShort = 1e-3;  // s: a step in which nothing turns by more than 1e-4 rad

    TestWorld world{Weightless()};
    BodyId a, b;
    const Position anchor{0.5, -0.2, 0.3};
    const Quaternion frame = RotationAbout({0.36f, 0.48f, 0.8f}, 0.7);

    explicit TwoBodies(double speed = 0, const Vector3& gravity = {0, 0, 0}, bool isDirect = false) {
        SystemSettings settings = world.System().Settings();
        settings.gravity = gravity;
        if (isDirect) settings.exactJointLoad = 0.1f;
        EXPECT_TRUE(world.System().SetSettings(settings));
        const auto s = static_cast<float>(speed);
        a = Add({0, 0, 0}, RotationAbout({0.6f, 0, 0.8f}, 0.5), 2, {0.3f, 0.5f, 0.7f},
                {Vector3(0.7f, -0.4f, 0.2f) * s, Vector3(-0.3f, 0.5f, 0.6f) * s});
        b = Add({0.8, 0.3, -0.2}, RotationAbout({0, 0.8f, -0.6f}, 0.9), 3, {0.9f, 0.4f, 0.6f},
                {Vector3(-0.2f, 0.6f, 0.5f) * s, Vector3(0.8f, 0.3f, -0.4f) * s});
    }

    JointSettings Between() const {
        JointSettings settings = testing::Between(a, b, anchor, ToMatrix(frame).x);
        settings.anchorA.normal = ToMatrix(frame).y;
        return settings;
    }
    // B's frame apart from A's by a way and a rotation along their axes.
    JointSettings Apart(const Vector3& way, const Vector3& turn) const {
        JointSettings settings = Between();
        const Quaternion turned = frame * RotationFromVector(turn);
        settings.anchorB = AnchorAt(anchor + Rotate(frame, way).cast<double>(), ToMatrix(turned).x);
        settings.anchorB->normal = ToMatrix(turned).y;
        return settings;
    }

    Motion Velocity() {
        Motion v;
        v << ToDense(world.VelocityOf(a)), ToDense(world.Bodies().GetAngularVelocity(a)), ToDense(world.VelocityOf(b)),
            ToDense(world.Bodies().GetAngularVelocity(b));
        return v;
    }
    // Since the creation, rotations as vectors.
    Motion Moved() {
        Motion moved;
        for (int i = 0; i < 2; ++i) {
            const BodyId id = i == 0 ? a : b;
            const Pose now = world.Bodies().GetPose(id);
            moved.segment<3>(6 * i) = ToDense(now.position - start_[i].position);
            moved.segment<3>(6 * i + 3) =
                ToDense(RotationVectorOf<float>(now.rotation * start_[i].rotation.Conjugate()));
        }
        return moved;
    }
    const Eigen::Matrix<double, 12, 12>& InverseMass() const { return inverseMass_; }
    // From a body's center of mass at the creation, m.
    Eigen::Vector3d Arm(BodyId body, const Position& point) const {
        return ToDense(point - start_[body == a ? 0 : 1].position);
    }

    // The Jacobian of B's motion against A along the frame's locked axes, with impulses that act at the anchor.
    Rows JacobianOf(const Locked& locked) const { return JacobianAt(anchor, anchor, locked); }
    // The same with impulses that act at these points of A and of B.
    Rows JacobianAt(const Position& pointA, const Position& pointB, const Locked& locked) const {
        const Eigen::Matrix3d axes = Columns(frame);
        Rows all = Rows::Zero(6, 12), rows(0, 12);
        for (int i = 0; i < 2; ++i) {
            const double sign = i == 0 ? -1 : 1;
            const Eigen::Vector3d arm = ToDense((i == 0 ? pointA : pointB) - start_[i].position);
            all.block<3, 3>(0, 6 * i) = sign * axes.transpose();
            all.block<3, 3>(0, 6 * i + 3) = -sign * axes.transpose() * CrossMatrix(arm);
            all.block<3, 3>(3, 6 * i + 3) = sign * axes.transpose();
        }
        for (int k = 0; k < 6; ++k) {
            if (!locked[static_cast<size_t>(k)]) continue;
            rows.conservativeResize(rows.rows() + 1, 12);
            rows.row(rows.rows() - 1) = all.row(k);
        }
        return rows;
    }
    // The least change of motion, measured by the masses, for which J change = -wanted.
    Motion LeastChange(const Rows& j, const Eigen::VectorXd& wanted) const {
        const Eigen::MatrixXd k = j * inverseMass_ * j.transpose();
        return -inverseMass_ * j.transpose() * k.ldlt().solve(wanted);
    }

private:
    BodyId Add(const Position& position, const Quaternion& rotation, double mass, const Vector3& inertia,
               const Twist<float>& velocity) {
        const int i = count_++;
        start_[i] = {position, rotation};
        const Eigen::Matrix3d axes = Columns(rotation);
        inverseMass_.block<3, 3>(6 * i, 6 * i) = Eigen::Matrix3d::Identity() / mass;
        inverseMass_.block<3, 3>(6 * i + 3, 6 * i + 3) =
            axes * ToDense(inertia).cwiseInverse().asDiagonal() * axes.transpose();
        return world.Add({.shape = BoxOf(0.1f, 0.1f, 0.1f),
                          .position = position,
                          .rotation = rotation,
                          .linearVelocity = velocity.linear,
                          .angularVelocity = velocity.angular,
                          .mass = static_cast<float>(mass),
                          .inertia = inertia});
    }

    int count_ = 0;
    Pose start_[2];
    Eigen::Matrix<double, 12, 12> inverseMass_ = Eigen::Matrix<double, 12, 12>::Zero();
};

// Joins bodies by some kind of joint that locks these axes.
struct Kind {
    std::string name;
    Locked locked;
    std::function<JointId(TestWorld&, const JointSettings&)> join;

    // Whether rows lock an axis, not blocks alone: a single axis of translation or of rotation, or a path.
    bool HasRows() const {
        return locked[0] + locked[1] + locked[2] == 1 || locked[3] + locked[4] + locked[5] == 1 ||
               name.starts_with("path");
    }
};

Kind SixDofOf(const Locked& locked) {
    std::string name = "six-dof ";
    for (const bool isLocked : locked) name += isLocked ? '1' : '0';
    return {name, locked, [locked](TestWorld& world, const JointSettings& between) {
                SixDofJointSettings settings = Of<SixDofJointSettings>(between);
                for (size_t k = 0; k < 6; ++k)
                    if (locked[k]) settings.axes[k] = kLockedAxis;
                return Join(world, settings);
            }};
}

// Each part alone, and each pair of parts; the rows of single axes.
std::vector<Kind> AllKinds() {
    std::vector<Kind> kinds;
    for (int bits = 1; bits < 64; ++bits) {
        Locked locked;
        int linear = 0, angular = 0;
        for (int k = 0; k < 6; ++k) {
            locked[static_cast<size_t>(k)] = bits >> k & 1;
            (k < 3 ? linear : angular) += bits >> k & 1;
        }
        // Two single rows are iterated: what one pass leaves is in no closed form.
        if (linear != 1 || angular != 1) kinds.push_back(SixDofOf(locked));
    }
    kinds.push_back({"fixed", {1, 1, 1, 1, 1, 1}, [](TestWorld& world, const JointSettings& s) {
                         return Join(world, FixedJointSettings{s});
                     }});
    kinds.push_back({"hinge", {1, 1, 1, 0, 1, 1}, [](TestWorld& world, const JointSettings& s) {
                         return Join(world, HingeJointSettings{s});
                     }});
    kinds.push_back({"slider", {0, 1, 1, 1, 1, 1}, [](TestWorld& world, const JointSettings& s) {
                         return Join(world, SliderJointSettings{s});
                     }});
    kinds.push_back({"point", {1, 1, 1, 0, 0, 0}, [](TestWorld& world, const JointSettings& s) {
                         return Join(world, PointJointSettings{s});
                     }});
    kinds.push_back({"swing-twist", {1, 1, 1, 0, 0, 0}, [](TestWorld& world, const JointSettings& s) {
                         SwingTwistJointSettings settings = Of<SwingTwistJointSettings>(s);
                         settings.twist = Limited(-1, 1);  // out of reach
                         return Join(world, settings);
                     }});
    // Rows that are locks. B begins at the middle of a straight path.
    const auto addPath = [&](const char* name, const Locked& locked, PathRotation rotation) {
        kinds.push_back({name, locked, [rotation](TestWorld& world, const JointSettings& s) {
                             PathJointSettings settings = Of<PathJointSettings>(s);
                             settings.rotation = rotation;
                             return Join(world, settings);
                         }});
    };
    addPath("path", {0, 1, 1, 0, 0, 0}, PathRotation::Free);
    addPath("path, tangent", {0, 1, 1, 0, 1, 1}, PathRotation::Tangent);
    addPath("path, tangent and normal", {0, 1, 1, 1, 1, 1}, PathRotation::TangentAndNormal);
    addPath("path, constant", {0, 1, 1, 1, 1, 1}, PathRotation::Constant);
    return kinds;
}

// One step takes from the velocities what a joint locks, by the least impulses that do so: the bodies' momentum is
// kept, and what is free stays as it was; a single pass does it, so that bodies move that way from the first substep
// on. Of numbers of order 0.1: rounding, and the turn of 1e-4 rad within the step.
TEST(PartsAtWork, AStepIsTheProjectionOntoWhatAJointAllows) {
    for (const bool isDirect : {false, true})
        for (const Kind& kind : AllKinds()) {
            TwoBodies pair(0.1, {0, 0, 0}, isDirect);
            kind.join(pair.world, pair.Between());
            const Motion before = pair.Velocity();
            const Rows j = pair.JacobianOf(kind.locked);
            pair.world.Step(TwoBodies::kShort);
            const Motion expected = before + pair.LeastChange(j, j * before);
            EXPECT_LT((pair.Velocity() - expected).norm(), 3e-5) << kind.name << " " << isDirect;
            EXPECT_LT((pair.Moved() - TwoBodies::kShort * expected).norm(), 1e-6) << kind.name << " " << isDirect;
        }
}

// Where the anchors are apart, impulses act halfway between them, those of lines at the anchor of B: on both bodies at
// the same point, which keeps the angular momentum. But no farther out than the longer arm.
TEST(PartsAtWork, ImpulsesActBetweenTheAnchors) {
    for (const double gap : {0.1, 5.0})
        for (const Kind& kind : AllKinds()) {
            const bool isPoint = kind.locked[0] && kind.locked[1] && kind.locked[2];
            const bool isLine = !isPoint && kind.locked[0] + kind.locked[1] + kind.locked[2] == 2;
            if (!isPoint && (!isLine || kind.name.starts_with("path"))) continue;
            TwoBodies pair(0.1);
            SystemSettings settings = pair.world.System().Settings();
            settings.jointPushSpeed = 1e-6f;  // no correction
            ASSERT_TRUE(pair.world.System().SetSettings(settings));
            JointSettings apart = pair.Apart(Vector3(0.6f, 0.48f, -0.64f) * static_cast<float>(gap), {0, 0, 0});
            kind.join(pair.world, apart);
            const Position pointB = apart.anchorB->point;
            Eigen::Vector3d across = ToDense(pointB - pair.anchor);
            if (isLine)
                for (int k = 0; k < 3; ++k)
                    if (!kind.locked[static_cast<size_t>(k)]) {
                        const Eigen::Vector3d free = Columns(pair.frame).col(k);
                        across -= free * free.dot(across);
                    }
            const Position onLine = pointB - Position(across.x(), across.y(), across.z());
            const double arm =
                std::max(pair.Arm(pair.a, isLine ? onLine : pair.anchor).norm(), pair.Arm(pair.b, pointB).norm());
            across *= std::min(1.0, arm / across.norm());
            const Position between(across.x(), across.y(), across.z());
            const Rows j = isLine ? pair.JacobianAt(onLine + between, pointB, kind.locked)
                                  : pair.JacobianAt(pair.anchor + between * 0.5, pointB - between * 0.5, kind.locked);
            const Motion before = pair.Velocity();
            pair.world.Step(TwoBodies::kShort);
            const Motion expected = before + pair.LeastChange(j, j * before);
            EXPECT_LT((pair.Velocity() - expected).norm(), 3e-5 * (1 + gap)) << kind.name << " " << gap;
        }
}

// The position pass corrects a fifth of the error in each of four substeps, by the least motion that does so, and
// leaves no velocity. To first order in errors of a millimeter and of a milliradian.
TEST(PartsAtWork, ErrorsCloseByAFifthInASubstep) {
    for (const bool isDirect : {false, true})
        for (const Kind& kind : AllKinds()) {
            // A direct solution corrects blocks alone: rows beside them are corrected before, and moved by it.
            if (isDirect && kind.HasRows()) continue;
            TwoBodies pair(0, {0, 0, 0}, isDirect);
            const Vector3 way(1e-3f, -0.7e-3f, 0.5e-3f), turn(-0.6e-3f, 0.8e-3f, 1.1e-3f);
            kind.join(pair.world, pair.Apart(way, turn));
            const SolverSettings& solver = pair.world.System().Settings().solver;
            const double closed =
                1 - std::pow(1 - double(solver.baumgarte), solver.substeps * solver.positionIterations);
            Eigen::VectorXd error(0);
            for (int k = 0; k < 6; ++k) {
                if (!kind.locked[static_cast<size_t>(k)]) continue;
                error.conservativeResize(error.size() + 1);
                error[error.size() - 1] = closed * double(k < 3 ? way[k] : turn[k - 3]);
            }
            pair.world.Step();
            const Motion expected = pair.LeastChange(pair.JacobianOf(kind.locked), error);
            EXPECT_LT((pair.Moved() - expected).norm(), 0.01 * expected.norm()) << kind.name << " " << isDirect;
            EXPECT_LT(pair.Velocity().norm(), 1e-6) << kind.name << " " << isDirect;
        }
}

// Rods, gears, racks and ropes: one row that acts on both bodies at its own points.
TEST(PartsAtWork, AStepOfASingleRowIsItsProjection) {
    using Eigen::Vector3d;
    const Position pointA(0.2, 0.4, -0.1), pointB(1.1, 0.1, 0.5);
    // ofA, ofB: the row's directions, a and b its angular parts.
    const auto expect = [&](const char* name, TwoBodies& pair, const Vector3d& ofA, const Vector3d& a,
                            const Vector3d& ofB, const Vector3d& b) {
        Rows j(1, 12);
        j << ofA.transpose(), a.transpose(), ofB.transpose(), b.transpose();
        const Motion before = pair.Velocity();
        ASSERT_GT((j * before)(0), 0.01) << name;  // it acts, if only to one side
        pair.world.Step(TwoBodies::kShort);
        const Motion expected = before + pair.LeastChange(j, j * before);
        EXPECT_LT((pair.Velocity() - expected).norm(), 3e-5) << name;
    };
    const auto between = [&](const TwoBodies& pair, const Vector3& axisA, const Vector3& axisB) {
        JointSettings settings = Between(pair.a, pair.b, pointA, axisA);
        settings.anchorB = AnchorAt(pointB, axisB);
        return settings;
    };
    const Vector3 axisA(0.48f, 0.6f, 0.64f), axisB(0.6f, -0.64f, -0.48f);
    const Vector3d n1 = ToDense(axisA), n2 = ToDense(axisB);
    {
        TwoBodies pair(-0.1);
        Join(pair.world, Of<DistanceJointSettings>(between(pair, axisA, axisB)));
        const Vector3d n = ToDense(pointB - pointA).normalized(), fromA = pair.Arm(pair.a, pointB),
                       fromB = pair.Arm(pair.b, pointB);
        expect("rod", pair, -n, -CrossMatrix(fromA) * n, n, CrossMatrix(fromB) * n);
    }
    {
        TwoBodies pair(0.1);
        GearJointSettings settings = Of<GearJointSettings>(between(pair, axisA, axisB));
        settings.ratio = 2.5f;
        Join(pair.world, settings);
        expect("gear", pair, Vector3d::Zero(), n1, Vector3d::Zero(), 2.5 * n2);
    }
    {
        TwoBodies pair(0.1);
        RackAndPinionJointSettings settings = Of<RackAndPinionJointSettings>(between(pair, axisA, axisB));
        settings.ratio = 3;
        Join(pair.world, settings);
        // Both impulses act at the pinion's anchor, along the rack.
        const Vector3d s = -3 * n2, fromA = pair.Arm(pair.a, pointA), fromB = pair.Arm(pair.b, pointA);
        expect("rack", pair, -s, n1 - CrossMatrix(fromA) * s, s, CrossMatrix(fromB) * s);
    }
    {
        TwoBodies pair(-0.1);
        PulleyJointSettings settings = Of<PulleyJointSettings>(between(pair, axisA, axisB));
        settings.fixedPointA = pointA - axisA.cast<double>() * 2.0;
        settings.fixedPointB = pointB - axisB.cast<double>() * 3.0;
        settings.ratio = 1.5f;
        Join(pair.world, settings);
        const Vector3d fromA = pair.Arm(pair.a, pointA), fromB = pair.Arm(pair.b, pointB);
        expect("pulley", pair, n1, CrossMatrix(fromA) * n1, 1.5 * n2, 1.5 * CrossMatrix(fromB) * n2);
    }
}

// The force and the torque about the anchor that a joint reads, in the step after this motion, are those that changed
// the motion of B.
void ExpectRead(TwoBodies& pair, JointId joint, const Motion& before) {
    const Eigen::Matrix<double, 6, 6> mass = pair.InverseMass().bottomRightCorner<6, 6>().inverse();
    const Eigen::Matrix<double, 6, 1> impulse = mass * (pair.Velocity() - before).tail<6>();
    const Eigen::Vector3d force = impulse.head<3>() / TwoBodies::kShort,
                          torque = impulse.tail<3>() / TwoBodies::kShort -
                                   CrossMatrix(pair.Arm(pair.b, pair.anchor)) * force;
    EXPECT_LT((ToDense(JointsOf(pair.world).GetForce(joint)) - force).norm(), 2e-3 * force.norm());
    EXPECT_LT((ToDense(JointsOf(pair.world).GetTorque(joint)) - torque).norm(), 2e-3 * (force.norm() + torque.norm()));
}

// The motor's speed is met by the least impulses that the locks let it have; a motor too weak for that adds what its
// force does in the step, and the locks take no work.
TEST(PartsAtWork, MotorsActThroughTheLocks) {
    const Locked hinge = {1, 1, 1, 0, 1, 1}, slider = {0, 1, 1, 1, 1, 1};
    for (const bool turns : {true, false}) {
        const Locked& locked = turns ? hinge : slider;
        Locked only{};
        only[turns ? 3 : 0] = true;
        const auto join = [&](TwoBodies& pair, const JointMotor& motor) {
            if (turns) {
                HingeJointSettings settings{pair.Between()};
                settings.angle.motor = motor;
                return Join(pair.world, settings);
            }
            SliderJointSettings settings{pair.Between()};
            settings.slide.motor = motor;
            return Join(pair.world, settings);
        };
        {
            TwoBodies pair(0.1);
            const JointId joint = join(pair, SpeedMotor(0.3));
            const Motion before = pair.Velocity();
            const Rows j = pair.JacobianOf({1, 1, 1, 1, 1, 1});
            Eigen::VectorXd wanted = j * before;
            wanted[turns ? 3 : 0] -= 0.3;
            pair.world.Step(TwoBodies::kShort);
            EXPECT_LT((pair.Velocity() - before - pair.LeastChange(j, wanted)).norm(), 5e-5) << turns;
            ExpectRead(pair, joint, before);
        }
        {
            TwoBodies pair;
            const double force = 20;
            const JointId joint = join(pair, SpeedMotor(100, force));
            const Motion pushed = pair.InverseMass() * pair.JacobianOf(only).transpose() * (force * TwoBodies::kShort);
            const Rows j = pair.JacobianOf(locked);
            pair.world.Step(TwoBodies::kShort);
            EXPECT_LT((pair.Velocity() - pushed - pair.LeastChange(j, j * pushed)).norm(), 0.002 * pushed.norm());
            EXPECT_NEAR(
                JointsOf(pair.world).GetAxisForces(joint, turns ? JointAxis::AngularX : JointAxis::LinearX).motor,
                force, 1e-4 * force);
            ExpectRead(pair, joint, Motion::Zero());
        }
    }
}

// What a joint to something static holds up of a body reads as its force and as its torque about the anchor, from the
// first step on, and in a step of another length.
TEST(PartsAtWork, AJointReadsWhatItHoldsUp) {
    for (const bool isDirect : {false, true})
        for (const Kind& kind : AllKinds()) {
            TwoBodies pair(0, {3, -8, 4}, isDirect);
            ASSERT_TRUE(pair.world.Bodies().SetMotionType(pair.a, MotionType::Static));
            const JointId joint = kind.join(pair.world, pair.Between());
            const Eigen::Matrix<double, Eigen::Dynamic, 6> j = pair.JacobianOf(kind.locked).rightCols<6>();
            const Eigen::Matrix<double, 6, 6> inverseMass = pair.InverseMass().bottomRightCorner<6, 6>();
            Eigen::Matrix<double, 6, 1> falls, acts = Eigen::Matrix<double, 6, 1>::Zero();
            falls << 3, -8, 4, 0, 0, 0;
            const Eigen::VectorXd impulses = (j * inverseMass * j.transpose()).ldlt().solve(-(j * falls));
            for (int k = 0, row = 0; k < 6; ++k)
                if (kind.locked[static_cast<size_t>(k)])
                    acts.segment<3>(k < 3 ? 0 : 3) += Columns(pair.frame).col(k % 3) * impulses[row++];
            for (const double dt : {TwoBodies::kShort, 0.5 * TwoBodies::kShort}) {
                pair.world.Step(dt);
                Eigen::Matrix<double, 6, 1> read;
                read << ToDense(JointsOf(pair.world).GetForce(joint)), ToDense(JointsOf(pair.world).GetTorque(joint));
                EXPECT_LE((read - acts).norm(), 1e-3 * acts.norm()) << kind.name << " " << dt << " " << isDirect;
                if (kind.HasRows()) continue;
                read << ToDense(JointsOf(pair.world).GetLockForce(joint)),
                    ToDense(JointsOf(pair.world).GetLockTorque(joint));
                EXPECT_LE((read - acts).norm(), 1e-3 * acts.norm()) << kind.name << " " << dt << " " << isDirect;
            }
        }
}

}  // namespace
}  // namespace fulcrum::testing
