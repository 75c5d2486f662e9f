#include <Fulcrum/Samples/Scenes/RestMeters.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

double OrInfinite(double value) { return std::isfinite(value) ? value : std::numeric_limits<double>::infinity(); }

bool IsDynamic(const PhysicsSystem& system, BodyId id) {
    return system.Bodies().GetMotionType(id) == MotionType::Dynamic;
}

// Against gravity, zero where there is none.
Position Up(const PhysicsSystem& system) {
    const Position gravity = system.Settings().gravity.cast<double>();
    const double size = gravity.norm();
    return size > 0 ? Position(gravity * (-1 / size)) : Position::Zero();
}

Pose CenterFrame(const PhysicsSystem& system, BodyId id) {
    return {system.Bodies().GetCenterOfMass(id), system.Bodies().GetPose(id).rotation};
}

Mat3<double> MatrixOf(const Quaternion& q) {
    return ToMatrix(Quat<double>{double{q.x}, double{q.y}, double{q.z}, double{q.w}});
}

bool IsSame(const Pose& a, const Pose& b) {
    const Quaternion &p = a.rotation, &q = b.rotation;
    return a.position == b.position && p.x == q.x && p.y == q.y && p.z == q.z && p.w == q.w;
}

// How far the corner that moves farthest is moved: of the box's center, plus along each edge the change of it, in the
// signs that add up to most.
double LargestMove(const Bounds& box, const Pose& from, const Pose& to) {
    const Mat3<double> a = MatrixOf(from.rotation), b = MatrixOf(to.rotation);
    const Position center = box.Center().cast<double>(), half = box.HalfExtents().cast<double>();
    const Position x = b.x - a.x, y = b.y - a.y, z = b.z - a.z;
    const Position middle = to.position - from.position + x * center.x() + y * center.y() + z * center.z();
    double largest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Position move = middle + x * ((corner & 1) ? half.x() : -half.x()) +
                              y * ((corner & 2) ? half.y() : -half.y()) + z * ((corner & 4) ? half.z() : -half.z());
        largest = std::max(largest, OrInfinite(move.norm()));
    }
    return largest;
}

template <class Step>
Result<std::optional<double>> StepUntilAsleep(const PhysicsSystem& system, double dt, double limit, const Step& step) {
    const int steps = StepsIn(limit, dt);
    for (int i = 1; i <= steps; ++i) {
        const Status status = step();
        if (!status) return status.GetError();
        if (AllAsleep(system)) return std::optional<double>(i * dt);
    }
    return std::optional<double>();
}

}  // namespace

DriftMeter::DriftMeter(const PhysicsSystem& system) : system_(system) {
    system.VisitBodies([&](BodyId id) {
        if (IsDynamic(system, id)) starts_.push_back({id, system.Bodies().GetCenterOfMass(id)});
    });
}

Drift DriftMeter::Measure() const {
    Drift drift;
    const Position up = Up(system_);
    size_t count = 0;
    for (const Start& start : starts_) {
        if (!system_.Bodies().Exists(start.id)) continue;
        const Position moved = system_.Bodies().GetCenterOfMass(start.id) - start.center;
        const double sideways = OrInfinite((moved - up * Dot<double>(moved, up)).norm());
        drift.mean += sideways;
        ++count;
        if (sideways <= drift.largest) continue;
        drift.largest = sideways;
        drift.farthest = start.id;
    }
    if (count > 0) drift.mean /= static_cast<double>(count);
    return drift;
}

double SpeedMeter::Note(double dt) {
    double largest = 0;
    system_.VisitBodies([&](BodyId id) {
        if (!IsDynamic(system_, id) || (dt > 0 && !system_.Bodies().IsAwake(id))) return;
        if (before_.size() <= id.index) before_.resize(id.index + 1);
        Placed& before = before_[id.index];
        const Placed now{id, CenterFrame(system_, id)};
        if (dt > 0 && before.id == id && !IsSame(before.center, now.center)) {
            const ShapePtr shape = system_.Bodies().GetShape(id);
            const double speed = LargestMove(shape->LocalBounds(), before.center, now.center) / dt;
            largest = std::max(largest, speed);
            if (speed > largest_) {
                largest_ = speed;
                fastest_ = id;
            }
        }
        before = now;
    });
    return largest;
}

EnergyMeter::EnergyMeter(const PhysicsSystem& system) : system_(system) {
    const double gravity = system.Settings().gravity.cast<double>().norm();
    system.VisitBodies([&](BodyId id) {
        if (!IsDynamic(system, id)) return;
        weight_ += gravity * double{system.Bodies().GetMass(id)};
        Note(id);
        awake_.push_back(id);
    });
    start_ = smallest_ = energy_;
}

void EnergyMeter::Measure() {
    for (const BodyId id : awake_)
        if (system_.Bodies().Exists(id) && !system_.Bodies().IsAwake(id)) Note(id);  // fell asleep
    awake_.clear();
    system_.VisitBodies([&](BodyId id) {
        if (!IsDynamic(system_, id) || !system_.Bodies().IsAwake(id)) return;
        Note(id);
        awake_.push_back(id);
    });
    rise_ = std::max(rise_, OrInfinite(energy_ - smallest_));
    smallest_ = std::min(smallest_, energy_);
}

void EnergyMeter::Note(BodyId id) {
    const BodyInterface& bodies = system_.Bodies();
    const Pose frame = CenterFrame(system_, id);
    const double energy =
        bodies.GetKineticEnergy(id) -
        double{bodies.GetMass(id)} * Dot<double>(system_.Settings().gravity.cast<double>(), frame.position);
    if (energies_.size() <= id.index) energies_.resize(id.index + 1);
    energy_ += energy - energies_[id.index];
    energies_[id.index] = energy;

    const Position up = Up(system_);
    const Bounds box = bodies.GetShape(id)->LocalBounds();
    const Mat3<double> axes = MatrixOf(frame.rotation);
    const Position center = box.Center().cast<double>(), half = box.HalfExtents().cast<double>();
    const Position along(Dot<double>(axes.x, up), Dot<double>(axes.y, up), Dot<double>(axes.z, up));
    const double height =
        Dot<double>(frame.position, up) + Dot<double>(along, center) - Dot<double>(along.cwiseAbs(), half);
    if (height < lowest_) lowest_ = height;
}

double EnergyMeter::RelativeRise() const {
    const double scale = weight_ > 0 ? start_ - weight_ * lowest_ : start_;
    if (scale > 0) return rise_ / scale;
    return rise_ > 0 ? std::numeric_limits<double>::infinity() : 0;
}

bool AllAsleep(const PhysicsSystem& system) {
    bool asleep = true;
    system.VisitBodies([&](BodyId id) { asleep = asleep && !(IsDynamic(system, id) && system.Bodies().IsAwake(id)); });
    return asleep;
}

Result<std::optional<double>> TimeToSleep(SceneWorld& world, double dt, double limit) {
    return StepUntilAsleep(world.System(), dt, limit, [&] { return world.Step(dt); });
}

Result<std::optional<double>> TimeToSleep(PhysicsSystem& system, double dt, double limit) {
    return StepUntilAsleep(system, dt, limit, [&] { return system.Update(dt); });
}

int StepsIn(double seconds, double dt) {
    const double exact = seconds / dt;
    return static_cast<int>(std::ceil(exact - 1e-6 * std::max(1.0, exact)));
}

}  // namespace fulcrum
