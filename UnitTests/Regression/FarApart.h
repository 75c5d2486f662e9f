// Two bodies whose joint is separated by SetPose, by up to 100 m and 180 degrees, of every kind and with everything on,
// and how they come together. Made from a seed. One thread.
#pragma once

#include <Fulcrum/Physics/Joints/JointKinds.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing::far_apart {

#define FULCRUM_KIND(kind) kind,
enum class Kind : uint8_t { FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_KIND) Count };
#undef FULCRUM_KIND
#define FULCRUM_NAME(kind) #kind,
inline constexpr const char* kNames[] = {FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_NAME)};
#undef FULCRUM_NAME
inline constexpr double kFastest = 65;     // m/s: what falls for five seconds is at 50
inline constexpr double kTogether = 0.05;  // m or rad
inline constexpr double kRackRatio = 3;    // rad/m
inline constexpr double kRounding =
    1e-3;  // of the energy of what falls for thousands of substeps, whose speed is a float
inline constexpr double kUnseen =
    0.06;  // of the work of motors and springs, of whose powers only the steps' ends are seen
inline constexpr double kHeld = 0.25;  // s that they must be together on end

// The result for a joint that was separated.
struct Recovery {
    double fastest = 0;     // m/s, of either body at any time
    double apart = 0;       // m or rad beyond the locks and the hard limits, at the end
    bool together = false;  // at some time for as long as kHeld
    double energy = 0;      // J, kinetic, at most
    double driven = 0;      // J: the work of motors and springs, all of it counted as positive
    double gained = 0;      // J: the most that it ever was above the work of gravity, motors and springs
    bool finite = true;
};

// A slider without locks: three rows, as a user might write it.
class RowsAlone final : public JointType {
public:
    explicit RowsAlone(const AxisControl& along) : along_(along) {}
    uint32_t MaxRows() const override { return MaxControlRows(along_) + 2; }
    void CollectRows(const JointPose& pose, JointRowList& rows) override {
        const Matrix3 frame = ToMatrix(pose.frameA);
        JointRow motion;
        pose.SetAlong(motion, frame.x);
        AddControlRows(along_, pose, motion, Dot(pose.offset, frame.x), kLinearSlackSpeed, 0, rows);
        uint32_t slot = ControlSlots::kCount;
        for (const Vector3& axis : {frame.y, frame.z}) {
            pose.SetAlong(motion, axis);
            AddLockRow({}, motion, Dot(pose.offset, axis), slot++, rows);
        }
    }
    AxisControl* Control(JointAxis axis) override { return axis == JointAxis::LinearX ? &along_ : nullptr; }

private:
    AxisControl along_;
};

struct Case {
    SystemSettings settings;
    double dt = kStep;
    bool hasFloor = false;
    bool isDriven = false;  // motors, soft limits
};

class FarApart {
public:
    FarApart(Kind kind, const Case& how, uint32_t seed) : kind_(kind), how_(how), random_(seed), world_(how.settings) {
        const double height = how.hasFloor ? 3 : 0;
        if (how.hasFloor) world_.AddFloor();
        a_ = world_.Add({.shape = CapsuleOf(0.5f, 0.3f), .position = {0, height, 0}});
        b_ = world_.Add({.shape = CubeOf(0.5f), .position = {1.2, height, 0}});
        base_ = UprightBetween(a_, b_, {0.6, height, 0});
        Make();
        world_.Steps(2, how.dt);
        PutApart();
    }

    // Five seconds of it.
    Recovery Run() {
        Recovery result;
        const int steps = static_cast<int>(5 / how_.dt + 0.5), held = static_cast<int>(kHeld / how_.dt + 0.5);
        int together = 0;
        Powers before = PowersNow();
        double work = 0, driven = 0;
        for (int i = 0; i < steps; ++i) {
            world_.Step(how_.dt);
            for (const BodyId id : {a_, b_})
                result.fastest = std::max(result.fastest, static_cast<double>(Length(world_.VelocityOf(id))));
            result.apart = Error();
            together = result.apart < kTogether ? together + 1 : 0;
            result.together |= together >= held;
            const Powers after = PowersNow();
            const double energy = Energy(), drives = 0.5 * how_.dt * DrivePower(before);
            work += 0.5 * (before.gravity + after.gravity) * how_.dt + drives;
            driven += std::fabs(drives);
            before = after;
            result.energy = std::max(result.energy, energy);
            result.driven = driven;
            // No more than there is: brakes of which only the steps' ends are seen seem to take what was never there.
            result.gained =
                std::max(result.gained, std::min(energy, energy * (1 - kRounding) - work - kUnseen * driven));
        }
        result.finite = world_.AllFinite();
        return result;
    }

private:
    double Between(double low, double high) {
        return static_cast<double>(random_.Between(static_cast<float>(low), static_cast<float>(high)));
    }
    bool Coin() { return random_.Chance(0.5f); }
    SpringSettings Soft() {
        return how_.isDriven && Coin() ? FrequencySpring(Between(1, 6), Between(0.1, 1)) : SpringSettings{};
    }

    // Everything on, where the case is driven.
    AxisControl Control(JointAxis axis, double low, double high) {
        const bool angular = axis >= JointAxis::AngularX;
        AxisControl control = Limited(low, high, Soft());
        if (IsHard(control.limits.spring)) limited_.push_back(axis);
        if (!how_.isDriven) return control;
        const double force = angular ? 200 : 2000;
        if (Coin()) {
            control.motor = SpeedMotor(Between(-2, 2), force);
        } else {
            control.motor = PositionMotor(Between(low, high), FrequencySpring(Between(0.5, 3), Between(0.3, 1)));
            if (Coin()) control.motor.maxForce = static_cast<float>(force);
        }
        control.friction = static_cast<float>(0.1 * force);
        return control;
    }

    void Make() {
        constexpr JointAxis kX = JointAxis::LinearX, kTurnX = JointAxis::AngularX, kTurnY = JointAxis::AngularY,
                            kTurnZ = JointAxis::AngularZ;
        switch (kind_) {
            case Kind::Point: joint_ = Join(world_, Of<PointJointSettings>(base_)); break;
            case Kind::Fixed: joint_ = Join(world_, Of<FixedJointSettings>(base_)); break;
            case Kind::Distance: {
                auto settings = Of<DistanceJointSettings>(base_);
                settings.minDistance = 0.2f;
                settings.maxDistance = static_cast<float>(Between(0.2, 1));
                settings.spring = Soft();
                if (IsHard(settings.spring)) limited_.push_back(kX);
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Hinge: {
                auto settings = Of<HingeJointSettings>(base_);
                settings.angle = Control(kTurnX, -0.8, 0.6);
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Slider: {
                auto settings = Of<SliderJointSettings>(base_);
                settings.slide = Control(kX, -0.5, 0.5);
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Cone: {
                auto settings = Of<ConeJointSettings>(base_);
                settings.halfAngle = static_cast<float>(Between(0.1, 1.5));
                settings.spring = Soft();
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::SwingTwist: {
                auto settings = Of<SwingTwistJointSettings>(base_);
                settings.shape = Coin() ? SwingShape::Ellipse : SwingShape::Pyramid;
                settings.twist = Control(kTurnX, -0.8, 0.6);
                settings.swingY = Control(kTurnY, -0.8, 0.8);
                settings.swingZ = Control(kTurnZ, -0.5, 0.5);
                // An ellipse is one limit, as soft as either.
                if (settings.shape == SwingShape::Ellipse &&
                    !(IsHard(settings.swingY.limits.spring) && IsHard(settings.swingZ.limits.spring)))
                    std::erase_if(limited_, [](JointAxis axis) { return axis == kTurnY || axis == kTurnZ; });
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::SixDof: {
                auto settings = Of<SixDofJointSettings>(base_);
                const int locked = static_cast<int>(Between(0, 63.9));
                for (int k = 0; k < 6; ++k) {
                    const auto axis = static_cast<JointAxis>(k);
                    settings[axis] = locked >> k & 1 ? kLockedAxis : Control(axis, -0.5, 0.5);
                }
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Gear: {
                auto settings = Of<GearJointSettings>(base_);
                settings.ratio = 2;
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::RackAndPinion: {
                auto settings = Of<RackAndPinionJointSettings>(base_);
                settings.ratio = static_cast<float>(kRackRatio);
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Pulley: {
                auto settings = Of<PulleyJointSettings>(base_);
                settings.fixedPointA = base_.anchorA.point + Position(-0.6, 4, 0);
                settings.fixedPointB = base_.anchorA.point + Position(1.4, 4, 0);
                settings.ratio = static_cast<float>(Between(0.5, 1));
                limited_.push_back(kX);
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Path: {
                auto settings = Of<PathJointSettings>(base_);
                const Vector3 places[] = {{-2, 0, 0}, {-1, 0.5f, 0}, {0, 0, 0.3f}, {1, -0.5f, 0}, {2, 0, 0}};
                const Vector3 up(0, 1, 0);
                settings.path = Path::CatmullRom(places, std::span(&up, 1), Coin()).Value();
                settings.rotation = static_cast<PathRotation>(static_cast<int>(Between(0, 3.9)));
                settings.along = Control(kX, 0.5, 3);
                limited_.clear();  // the way is not the place: see Error
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Wheel: {
                WheelJointSettings settings;
                static_cast<JointSettings&>(settings) = base_;
                settings.isSteered = Coin();
                if (how_.isDriven) settings.spin = Control(kTurnX, -1, 1);
                else settings.suspension.motor = settings.steering.motor = {};
                limited_.push_back(JointAxis::LinearY);
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Custom: {
                auto settings = Of<CustomJointSettings>(base_);
                const AxisControl along = Control(kX, -0.5, 0.5);
                settings.make = [along] { return std::make_unique<RowsAlone>(along); };
                joint_ = Join(world_, settings);
                break;
            }
            case Kind::Count: break;
        }
    }

    // B anywhere within 100 m, turned by anything; at rest, above the floor.
    void PutApart() {
        const double distance = Between(0, 100);
        Position place = world_.PositionOf(b_) + random_.Direction().cast<double>() * distance;
        if (how_.hasFloor) place.y() = std::max(place.y(), 2 + 0.1 * std::fabs(place.y()));
        ASSERT_TRUE(world_.Bodies().SetPose(b_, place, RotationAbout(random_.Direction(), Between(0, kPi))));
        for (const BodyId id : {a_, b_})
            ASSERT_TRUE(world_.Bodies().SetVelocity(id, Vector3(0, 0, 0), Vector3(0, 0, 0)));
    }

    // m or rad beyond the locks and the hard limits.
    double Error() {
        if (kind_ == Kind::Gear || kind_ == Kind::RackAndPinion)
            return std::fabs(CollectRows().error) / (kind_ == Kind::Gear ? 1 : kRackRatio);
        const JointError locks = JointsOf(world_).GetError(joint_);
        double error = std::max(locks.distance, locks.angle);
        for (const JointAxis axis : limited_) {
            const JointLimits& limits = JointsOf(world_).GetControl(joint_, axis)->limits;
            const double place = JointsOf(world_).GetCoordinate(joint_, axis);
            error = std::max({error, place - static_cast<double>(limits.max), static_cast<double>(limits.min) - place});
        }
        if (kind_ != Kind::Path && kind_ != Kind::Custom) return error;
        const Vector3 apart =
            (JointsOf(world_).GetFrameB(joint_).position - JointsOf(world_).GetFrameA(joint_).position).cast<float>();
        const Vector3 local = InverseRotate(JointsOf(world_).GetFrameA(joint_).rotation, apart);
        if (kind_ == Kind::Custom)
            return std::max(error, std::hypot(static_cast<double>(local.y()), static_cast<double>(local.z())));
        const Path& path = static_cast<const PathJoint*>(JointsOf(world_).GetType(joint_))->GetPath();
        const PathSample at = path.Sample(path.Closest(local));
        Vector3 away = local - at.position;
        // A soft limit lets B run beyond the end of an open path, along its tangent.
        if (!IsHard(JointsOf(world_).GetControl(joint_, JointAxis::LinearX)->limits.spring))
            away -= at.tangent * Dot(away, at.tangent);
        return std::max(error, static_cast<double>(Length(away)));
    }

    // What a step that began now would have: rows in the order of their type, and the rates of what they measure.
    struct RowsNow {
        std::array<Twist<float>, JointRowList::kMaxRows> a{}, b{};  // J by slot
        double error = 0;                                           // of the first, in its units
        std::array<double, JointRowList::kMaxRows> rate{};          // m/s or rad/s, by slot
        std::array<bool, JointRowList::kMaxRows> drives{};          // motors and springs
    };
    RowsNow CollectRows() {
        const JointType* type = JointsOf(world_).GetType(joint_);
        const Pose a = JointsOf(world_).GetFrameA(joint_), b = JointsOf(world_).GetFrameB(joint_);
        JointPose pose;
        pose.armA = (a.position - world_.PositionOf(a_)).cast<float>();
        pose.armB = (b.position - world_.PositionOf(b_)).cast<float>();
        pose.offset = (b.position - a.position).cast<float>();
        pose.frameA = a.rotation;
        pose.frameB = b.rotation;
        pose.velocityA = {world_.VelocityOf(a_), world_.Bodies().GetAngularVelocity(a_)};
        pose.velocityB = {world_.VelocityOf(b_), world_.Bodies().GetAngularVelocity(b_)};
        pose.dt = static_cast<float>(how_.dt);
        pose.substepDt = pose.dt / static_cast<float>(how_.settings.solver.substeps);
        pose.anchorA = a.position;
        pose.turnedA = type->turnedA;
        pose.turnedB = type->turnedB;
        JointRowList list;
        const auto collect = [&](auto copy) { copy.CollectRows(pose, list); };
        switch (kind_) {
            case Kind::Distance: collect(static_cast<const DistanceJoint&>(*type)); break;
            case Kind::Hinge: collect(static_cast<const HingeJoint&>(*type)); break;
            case Kind::Slider: collect(static_cast<const SliderJoint&>(*type)); break;
            case Kind::Cone: collect(static_cast<const ConeJoint&>(*type)); break;
            case Kind::SwingTwist: collect(static_cast<const SwingTwistJoint&>(*type)); break;
            case Kind::SixDof: collect(static_cast<const SixDofJoint&>(*type)); break;
            case Kind::Gear: collect(static_cast<const GearJoint&>(*type)); break;
            case Kind::RackAndPinion: collect(static_cast<const RackAndPinionJoint&>(*type)); break;
            case Kind::Pulley: collect(static_cast<const PulleyJoint&>(*type)); break;
            case Kind::Path: collect(static_cast<const PathJoint&>(*type)); break;
            case Kind::Wheel: collect(static_cast<const WheelJoint&>(*type)); break;
            case Kind::Custom: collect(static_cast<const RowsAlone&>(*type)); break;
            case Kind::Point:
            case Kind::Fixed:
            case Kind::Count: break;
        }
        RowsNow rows;
        for (uint32_t i = 0; i < list.count; ++i) {
            const JointRow& row = list.rows[i];
            if (i == 0) rows.error = static_cast<double>(row.error);
            rows.a[row.slot] = row.jacobian.a;
            rows.b[row.slot] = row.jacobian.b;
            rows.rate[row.slot] = static_cast<double>(pose.SpeedOf(row));
            rows.drives[row.slot] = row.kind == JointRow::Kind::Spring || row.kind == JointRow::Kind::SpringAtLeast ||
                                    (row.kind == JointRow::Kind::Speed && row.speed != 0);
        }
        return rows;
    }

    // W. Of gravity by the velocities that bodies keep: what a pull lifts takes no speed from it.
    struct Powers {
        double gravity = 0;
        RowsNow rows;
    };
    Powers PowersNow() {
        Powers powers;
        for (const BodyId id : {a_, b_})
            powers.gravity +=
                static_cast<double>(world_.Bodies().GetMass(id) * Dot(how_.settings.gravity, world_.VelocityOf(id)));
        powers.rows = CollectRows();
        return powers;
    }
    // W, twice: of motors and springs in the step between, by their mean forces.
    double DrivePower(const Powers& before) {
        const JointType& type = *JointsOf(world_).GetType(joint_);
        double power = 0;
        for (size_t slot = 0; slot < type.forces.size(); ++slot) {
            if (!before.rows.drives[slot]) continue;
            JointPose end;
            end.velocityA = {world_.VelocityOf(a_), world_.Bodies().GetAngularVelocity(a_)};
            end.velocityB = {world_.VelocityOf(b_), world_.Bodies().GetAngularVelocity(b_)};
            JointRow row;
            row.jacobian.a = before.rows.a[slot];
            row.jacobian.b = before.rows.b[slot];
            power += static_cast<double>(type.forces[slot]) *
                     (before.rows.rate[slot] + static_cast<double>(end.SpeedOf(row)));
        }
        return power;
    }
    double Energy() { return world_.Bodies().GetKineticEnergy(a_) + world_.Bodies().GetKineticEnergy(b_); }  // J

    Kind kind_;
    Case how_;
    RandomPoses random_;
    TestWorld world_;
    BodyId a_, b_;
    JointSettings base_;
    JointId joint_;
    std::vector<JointAxis> limited_;
};

inline Case CaseOf(uint32_t i) {
    Case how;
    how.settings = Weightless();
    how.isDriven = i % 2 == 1;
    how.settings.solver.substeps = i % 8 == 2 ? 1 : i % 8 == 4 ? 2 : i % 8 == 6 ? 16 : 4;
    how.dt = i % 5 == 3 ? 1.0 / 30 : i % 5 == 4 ? 1.0 / 240 : kStep;
    if (i % 8 == 3 || i % 8 == 5) {
        how.settings.solver.substeps = 1;
        how.dt /= 4;
    }
    if (i % 3 == 1) how.settings.gravity = Vector3(0, -9.81f, 0);
    how.hasFloor = i % 6 == 1 || i % 12 == 4;
    return how;
}

}  // namespace fulcrum::testing::far_apart
