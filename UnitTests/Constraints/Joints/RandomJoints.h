// Joints of every kind between random bodies, as input of the solver: with locks alone and with rows. For the tests and
// the benchmarks of the joint kernels, so without a test library. One thread.
#pragma once

#include <Fulcrum/Constraints/BodyLanes.h>
#include <Fulcrum/Constraints/Joints/JointBatch.h>
#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/UnitTests/Constraints/Parts/RandomBodies.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <span>
#include <vector>

namespace fulcrum::testing {

// A kind of joint in one state, and where B is, seen from A's frame.
struct JointCase {
    const char* kind;
    const char* state;
    std::unique_ptr<JointType> (*make)(const Position& anchorA);
    Vector3 offset = Vector3::Zero();  // m
    Vector3 turn = Vector3::Zero();    // rotation vector, rad
};

namespace joint_cases {

inline AxisControl Limits(float min, float max) {
    AxisControl control;
    control.limited = true;
    control.limits.min = min;
    control.limits.max = max;
    return control;
}
inline AxisControl Speed(float speed) {
    AxisControl control;
    control.motor.mode = MotorMode::ToVelocity;
    control.motor.targetSpeed = speed;
    control.motor.maxForce = 50.0f;
    control.motor.minForce = -50.0f;
    return control;
}
inline AxisControl Place(AxisControl control, float place) {
    control.motor.mode = MotorMode::ToPosition;
    control.motor.targetPosition = place;
    return control;
}
template <class Type, class... Arguments>
std::unique_ptr<JointType> Make(Arguments&&... arguments) {
    return std::make_unique<Type>(std::forward<Arguments>(arguments)...);
}
inline std::shared_ptr<const Path> Curve() {
    const Vector3 places[] = {Vector3(-2, 0, 0), Vector3(-1, 0.5f, 0), Vector3(0, 0, 0.3f), Vector3(1, -0.5f, 0),
                              Vector3(2, 0, 0)};
    const Vector3 up(0, 1, 0);
    return Path::CatmullRom(places, std::span(&up, 1), false).Value();
}
inline AxisControl Suspension() { return Place(Limits(-0.2f, 0.2f), 0.0f); }
inline std::array<AxisControl, 6> Shoulder(bool driven) {
    std::array<AxisControl, 6> axes;
    for (size_t k = 0; k < 6; ++k) {
        axes[k].limited = k < 3;
        if (k >= 3 && driven) axes[k] = Place(Limits(-1, 1), 0.2f);
    }
    return axes;
}

}  // namespace joint_cases

// Every kind with no rows, if it can be, and with rows.
inline std::span<const JointCase> AllJointCases() {
    using namespace joint_cases;
    using Place3 = const Position&;
    static const JointCase kCases[] = {
        {"point", "locks", [](Place3) { return Make<PointJoint>(); }},
        {"fixed", "locks", [](Place3) { return Make<FixedJoint>(); }},
        {"distance", "slack", [](Place3) { return Make<DistanceJoint>(0.0f, 2.0f, SpringSettings{}); }, {1, 0, 0}},
        {"distance", "rod", [](Place3) { return Make<DistanceJoint>(1.0f, 1.0f, SpringSettings{}); }, {1, 0, 0}},
        {"hinge", "locks", [](Place3) { return Make<HingeJoint>(AxisControl{}); }},
        {"hinge", "motor", [](Place3) { return Make<HingeJoint>(Speed(3)); }},
        {"slider", "locks", [](Place3) { return Make<SliderJoint>(AxisControl{}); }},
        {"slider", "limit", [](Place3) { return Make<SliderJoint>(Limits(-1, 0.3f)); }, {0.3f, 0, 0}},
        {"cone", "locks", [](Place3) { return Make<ConeJoint>(0.8f, SpringSettings{}); }},
        {"cone", "limit", [](Place3) { return Make<ConeJoint>(0.8f, SpringSettings{}); }, {0, 0, 0}, {0, 0, 0.8f}},
        {"swing-twist", "locks",
         [](Place3) {
             return Make<SwingTwistJoint>(Limits(-1, 1), Limits(-1, 1), Limits(-0.7f, 0.7f), SwingShape::Ellipse);
         }},
        {"swing-twist",
         "limits",
         [](Place3) {
             return Make<SwingTwistJoint>(Limits(-1, 0), Limits(-1, 1), Limits(-0.7f, 0.7f), SwingShape::Ellipse);
         },
         {0, 0, 0},
         {0, 0, 0.7f}},
        {"six-dof", "locks", [](Place3) { return Make<SixDofJoint>(Shoulder(false), SwingShape::Pyramid); }},
        {"six-dof", "motors", [](Place3) { return Make<SixDofJoint>(Shoulder(true), SwingShape::Pyramid); }},
        {"gear", "row", [](Place3) { return Make<GearJoint>(2.0f); }, {1, 0, 0}},
        {"rack and pinion", "row", [](Place3) { return Make<RackAndPinionJoint>(4.0f); }, {0, 0.25f, 0}},
        {"pulley",
         "slack",
         [](Place3 a) {
             return Make<PulleyJoint>(Position(a + Position(0, 3, 0)), Position(a + Position(1, 3, 0)), 1.0f, 0.0f,
                                      8.0f);
         },
         {1, 0, 0}},
        {"pulley",
         "taut",
         [](Place3 a) {
             return Make<PulleyJoint>(Position(a + Position(0, 3, 0)), Position(a + Position(1, 3, 0)), 1.0f, 0.0f,
                                      std::nullopt);
         },
         {1, 0, 0}},
        {"path",
         "rides",
         [](Place3) { return Make<PathJoint>(Curve(), AxisControl{}, PathRotation::Free); },
         {0.4f, -0.2f, 0.2f}},
        {"path",
         "motor",
         [](Place3) { return Make<PathJoint>(Curve(), Speed(1), PathRotation::Free); },
         {0.4f, -0.2f, 0.2f}},
        {"wheel", "suspension",
         [](Place3) { return Make<WheelJoint>(Suspension(), false, AxisControl{}, AxisControl{}); }},
        {"wheel", "steered, driven",
         [](Place3) { return Make<WheelJoint>(Suspension(), true, Place(Limits(-0.6f, 0.6f), 0.1f), Speed(20)); }},
    };
    return kCases;
}

// The solver's settings at the system's defaults.
inline JointSolveSettings DefaultJointSettings() {
    constexpr float kSubstep = 1.0f / 240;
    JointSolveSettings settings{};
    settings.dt = 4 * kSubstep;
    settings.substepDt = kSubstep;
    settings.inverseDt = 240;
    settings.impulseScale = 1;
    settings.maxPushSpeed = 20;
    settings.baumgarte = 0.2f;
    return settings;
}

// Joint i is of case i modulo their number, between two bodies of its own whose indices are anywhere.
class RandomJoints {
public:
    // In a plane, all that is perpendicular to z = 0 is zero, half of it negative: zeros must keep their signs.
    struct Options {
        bool someFixed = false;  // some second bodies do not move, or are kinematic
        bool inPlane = false;
    };
    std::vector<BodyState> states;
    std::vector<BodyMass> masses;
    std::vector<BodyPose> poses;
    std::vector<JointRecord> records;
    std::vector<std::unique_ptr<JointType>> types;
    std::vector<JointType*> typePointers;

    RandomJoints(std::span<const JointCase> cases, uint32_t count, uint32_t seed, const Options& options)
        : states(2 * count), masses(2 * count), poses(2 * count), records(count), random_(seed), options_(options) {
        places_.resize(2 * count);
        std::iota(places_.begin(), places_.end(), 0u);
        for (uint32_t i = 2 * count; i-- > 1;) std::swap(places_[i], places_[Below(i + 1)]);
        kinds_.resize(2 * count, Kind::Dynamic);
        for (uint32_t i = 0; i < count; ++i) Add(i, cases[i % cases.size()]);
    }

    // Half of the impulses of the joints, which the caller has added to `starts`, changes the velocities.
    void ApplyHalf(std::span<WarmStart> starts) {
        for (size_t body = 0; body < states.size(); ++body) {
            WarmStart& start = starts[body];
            const float(&l)[3] = start.angularImpulse;
            const Vector3 turn = masses[body].InverseInertia() * Vector3(l[0], l[1], l[2]);
            for (int k = 0; k < 3; ++k) {
                states[body].linearVelocity[k] += 0.5f * masses[body].inverseMass * start.impulse[k];
                states[body].angularVelocity[k] += 0.5f * turn[k];
            }
            start.SetScale(0.5f);
        }
    }
    // Moves the bodies for h seconds; inertias that turn change as if they had.
    void Move(float h) {
        for (size_t body = 0; body < states.size(); ++body) {
            if (!Moves(static_cast<uint32_t>(body))) continue;
            BodyState& s = states[body];
            for (int k = 0; k < 3; ++k) {
                s.deltaPosition[k] += s.linearVelocity[k] * h;
                s.deltaRotation[k] += s.angularVelocity[k] * h;
            }
            const Vector3 turn(s.deltaRotation[0], s.deltaRotation[1], s.deltaRotation[2]);
            const Vec2<float> half = HalfTurnOf<float>(turn);
            for (int k = 0; k < 2; ++k) s.halfTurn[k] = half[k];
            BodyMass& mass = masses[body];
            if (static_cast<int>(mass.flags) & BodyMass::kTurns)
                for (float& x : mass.inverseInertia) x *= 1.1f;
        }
    }

    SolverBodies Bodies() { return {states.data(), masses.data(), poses.data()}; }
    bool Moves(uint32_t body) const { return kinds_[body] == Kind::Dynamic; }

    // The joints of each pair of locks in batches, and room for their rows in `rows`.
    template <int N>
    std::vector<JointBatch<N>> Batches(std::vector<JointRows<N>>& rows) const {
        std::vector<JointBatch<N>> batches;
        for (int locks = 0; locks < 9; ++locks) {
            std::vector<uint32_t> joints;
            for (uint32_t i = 0; i < types.size(); ++i)
                if (LocksOf(i) == locks) joints.push_back(i);
            for (size_t first = 0; first < joints.size(); first += N)
                batches.push_back(
                    BatchOf<N>(std::span(joints).subspan(first, std::min<size_t>(N, joints.size() - first))));
        }
        size_t count = 0;
        for (const JointBatch<N>& batch : batches) count += batch.rowRoom;
        rows.resize(count);
        count = 0;
        for (JointBatch<N>& batch : batches) {
            batch.rows = rows.data() + count;
            count += batch.rowRoom;
        }
        return batches;
    }

private:
    enum class Kind : uint8_t { Dynamic, Kinematic, Static };

    uint32_t Below(uint32_t n) {
        return std::min(static_cast<uint32_t>(random_.Between(0.0f, static_cast<float>(n))), n - 1);
    }

    int LocksOf(uint32_t joint) const {
        const JointLocks locks = types[joint]->Locks();
        return static_cast<int>(locks.linear) * 3 + static_cast<int>(locks.angular);
    }

    template <int N>
    JointBatch<N> BatchOf(std::span<const uint32_t> joints) const {
        JointBatch<N> batch{};
        batch.count = static_cast<int32_t>(joints.size());
        const JointLocks locks = types[joints[0]]->Locks();
        batch.linear = locks.linear;
        batch.angular = locks.angular;
        for (size_t lane = 0; lane < N; ++lane) {
            const uint32_t joint = joints[std::min(lane, joints.size() - 1)];
            batch.joint[lane] = joint;
            batch.bodyA[lane] = places_[2 * joint];
            batch.bodyB[lane] = places_[2 * joint + 1];
            batch.fixedB |= static_cast<uint32_t>(kinds_[batch.bodyB[lane]] != Kind::Dynamic) << lane;
            batch.kinematicB |= static_cast<uint32_t>(kinds_[batch.bodyB[lane]] == Kind::Kinematic) << lane;
            batch.rowRoom = std::max(batch.rowRoom, types[joint]->MaxRows());
        }
        return batch;
    }

    Vector3 Vector(float size) {
        const Vector3 v = random_.InBox(size);
        return options_.inPlane ? Vector3(v.x(), v.y(), std::copysign(0.0f, v.z())) : v;
    }
    Vector3 Turning(float size) {
        const Vector3 v = random_.InBox(size);
        return options_.inPlane ? Vector3(std::copysign(0.0f, v.x()), std::copysign(0.0f, v.y()), v.z()) : v;
    }

    void AddBody(uint32_t body, Kind kind, const Position& place, const Quaternion& rotation) {
        kinds_[body] = kind;
        BodyState& state = states[body];
        BodyPose& pose = poses[body];
        const Vector3 linear = Vector(0.5f), angular = Turning(0.5f), way = Vector(0.01f), turn = Turning(0.01f);
        for (int k = 0; k < 3; ++k) {
            pose.position[k] = place[k];
            if (kind == Kind::Static) continue;
            state.linearVelocity[k] = linear[k];
            state.angularVelocity[k] = angular[k];
            if (kind == Kind::Kinematic) continue;
            state.deltaPosition[k] = way[k];
            state.deltaRotation[k] = turn[k];
        }
        const float q[4] = {rotation.x, rotation.y, rotation.z, rotation.w};
        std::copy(q, q + 4, pose.rotation);
        if (kind != Kind::Dynamic) return;
        const float a = random_.Between(2.0f, 9.0f), b = random_.Between(2.0f, 9.0f), c = random_.Between(2.0f, 9.0f);
        const SymmetricMatrix3 inertia = RotatedDiagonal(ToMatrix(rotation), Vector3(a, b, c));
        const float rows[6] = {inertia.xx, inertia.yy, inertia.zz, inertia.xy, inertia.xz, inertia.yz};
        std::copy(rows, rows + 6, masses[body].inverseInertia);
        masses[body].inverseMass = random_.Between(0.5f, 2.0f);
        masses[body].flags = random_.Between(0.0f, 1.0f) < 0.3f ? 1.0f : 0.0f;
    }

    void Add(uint32_t joint, const JointCase& how) {
        const auto turned = [](const Vector3& v) { return RotationFromVector(v); };
        const uint32_t a = places_[2 * joint], b = places_[2 * joint + 1];
        const float kind = random_.Between(0.0f, 1.0f);
        const Kind kindOfB = !options_.someFixed || kind < 0.7f ? Kind::Dynamic
                             : kind < 0.85f                     ? Kind::Kinematic
                                                                : Kind::Static;
        const Vector3 anchorA = Vector(0.5f), anchorB = Vector(0.5f);
        const Quaternion rotationA = turned(Turning(2.0f)), inA = turned(Turning(2.0f)), inB = turned(Turning(2.0f));
        const Quaternion frameA = rotationA * inA;
        const Quaternion frameB = frameA * turned(how.turn) * turned(Turning(0.005f));
        const Quaternion rotationB = Normalized(frameB * inB.Conjugate());
        const Vector3 placeA = Vector(3.0f), gap = Vector(0.003f);
        const Vector3 armA = Rotate(rotationA, anchorA), armB = Rotate(rotationB, anchorB);
        const Vector3 offset = Rotate(frameA, how.offset) + gap;
        AddBody(a, Kind::Dynamic, placeA.cast<double>(), rotationA);
        AddBody(b, kindOfB, Vector3(placeA + armA + offset - armB).cast<double>(), rotationB);

        types.push_back(how.make(Vector3(placeA + armA).cast<double>()));
        JointType& type = *types.back();
        typePointers.push_back(&type);
        JointPose pose;
        pose.armA = armA;
        pose.armB = armB;
        pose.offset = offset;
        pose.frameA = frameA;
        pose.frameB = frameB;
        pose.anchorA = Vector3(placeA + armA).cast<double>();
        type.Start(pose);
        if (type.MaxRows() > 0)
            for (float& impulse : type.impulses) impulse = random_.Between(-0.05f, 0.05f);

        JointRecord& record = records[joint];
        const Vector3 force = Vector(0.1f), torque = Turning(0.1f);
        for (int k = 0; k < 3; ++k) {
            record.anchorA[k] = anchorA[k];
            record.anchorB[k] = anchorB[k];
            record.ownImpulse[k] = force[k];
            record.ownAngularImpulse[k] = torque[k];
        }
        const float frames[2][4] = {{inA.x, inA.y, inA.z, inA.w}, {inB.x, inB.y, inB.z, inB.w}};
        std::copy(frames[0], frames[0] + 4, record.frameA);
        std::copy(frames[1], frames[1] + 4, record.frameB);
        record.lineAxis = type.Locks().line;
        record.freeAxis = type.Locks().axis;
    }

    RandomPoses random_;
    Options options_;
    std::vector<uint32_t> places_;
    std::vector<Kind> kinds_;
};

}  // namespace fulcrum::testing
