#include <Fulcrum/UnitTests/Random/Structures.h>

#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/UnitTests/Random/Controls.h>

#include <algorithm>

namespace fulcrum::testing {

namespace {

constexpr double kLeastMass = 0.1, kMostMass = 100;  // kg

Vector3 Perpendicular(RandomPoses& random, const Vector3& axis) {
    for (;;) {
        const Vector3 across = Cross(axis, random.Direction());
        if (Length(across) > 0.3f) return Normalized(across);
    }
}

// Of a bend through the origin.
std::shared_ptr<const Path> RandomPath(RandomPoses& random) {
    const Vector3 before = random.InBox(0.5f), after = random.InBox(0.5f);
    const Vector3 places[] = {before - Vector3(2, 0, 0), before * 0.5f - Vector3(1, 0, 0), Vector3::Zero(),
                              after * 0.5f + Vector3(1, 0, 0), after + Vector3(2, 0, 0)};
    const Vector3 up(0, 1, 0);
    return Path::CatmullRom(places, std::span(&up, 1), false).Value();
}

class StructureMaker {
public:
    StructureMaker(StructureKind kind, uint64_t seed) : kind_(kind), random_(RandomOf(seed)) {}

    Mechanism Make() {
        const uint32_t bodies = 2 + random_.Below(7);
        AddBody();
        for (uint32_t i = 1; i < bodies; ++i) {
            const BodyId parent = AnyBody();
            Connect(parent, AddBody());
        }
        if (random_.Chance(0.15f)) structure_.bodies[random_.Below(bodies)].mass *= 10;
        if (kind_ == StructureKind::Graph) CloseLoops();
        if (random_.Chance(0.6f)) {
            const uint32_t anchors = 1 + random_.Below(2);
            for (uint32_t i = 0; i < anchors; ++i) Connect(kWorldBody, AnyBody());
            if (kind_ == StructureKind::Graph) AddTransmissions();
        }
        return std::move(structure_);
    }

private:
    const Position& PlaceOf(BodyId id) const { return structure_.bodies[BodyBatch::IndexOf(id)].position; }
    BodyId AnyBody() { return BodyBatch::Body(random_.Below(static_cast<uint32_t>(structure_.bodies.size()))); }

    ShapePtr AnyShape() {
        const float a = random_.Between(0.05f, 0.5f), b = random_.Between(0.05f, 0.5f),
                    c = random_.Between(0.05f, 0.5f);
        switch (random_.Below(3)) {
            case 0: return Box::Create(Vector3(a, b, c)).Value();
            case 1: return Sphere::Create(a).Value();
            default: return Capsule::Create(a, b).Value();
        }
    }
    BodyId AddBody() {
        const Vector3 place = random_.InBox(2);
        const Quaternion rotation = random_.Rotation();
        const ShapePtr shape = AnyShape();
        structure_.bodies.push_back({.shape = shape,
                                     .position = place.cast<double>(),
                                     .rotation = rotation,
                                     .mass = LogBetween(random_, kLeastMass, kMostMass),
                                     .mask = 0});
        return BodyBatch::Body(static_cast<uint32_t>(structure_.bodies.size() - 1));
    }
    Position NearBody(BodyId id, float most) { return PlaceOf(id) + random_.InBox(most).cast<double>(); }

    // Somewhere between the bodies, with a random frame.
    JointSettings Between(BodyId a, BodyId b) {
        JointSettings between;
        between.bodyA = a;
        between.bodyB = b;
        const Position from = a == kWorldBody ? NearBody(b, 1) : PlaceOf(a);
        const double part = static_cast<double>(random_.Between(0, 1));
        between.anchorA.point = from + (PlaceOf(b) - from) * part + random_.InBox(0.5f).cast<double>();
        between.anchorA.axis = random_.Direction();
        between.anchorA.normal = Perpendicular(random_, between.anchorA.axis);
        return between;
    }

    void Connect(BodyId a, BodyId b) {
        const JointSettings between = Between(a, b);
        switch (random_.Below(10)) {
            case 0: return Add(Of<PointJointSettings>(between));
            case 1: return Add(Of<FixedJointSettings>(between));
            case 2: {
                auto hinge = Of<HingeJointSettings>(between);
                hinge.angle = RandomControl(random_, 2);
                return Add(hinge);
            }
            case 3: {
                auto slider = Of<SliderJointSettings>(between);
                slider.slide = RandomControl(random_, 1);
                return Add(slider);
            }
            case 4: return Add(MakeRod(between));
            case 5: return Add(MakeCone(between));
            case 6: return Add(MakeShoulder(between));
            case 7: return Add(MakeSixDof(between));
            case 8: {
                auto path = Of<PathJointSettings>(between);
                path.path = RandomPath(random_);
                path.along.friction = random_.Chance(0.3f) ? LogBetween(random_, 0.01, 10) : 0;
                if (random_.Chance(0.2f)) path.along.motor.mode = MotorMode::ToVelocity;
                path.rotation = random_.Chance(0.5f) ? PathRotation::Free : PathRotation::Constant;
                return Add(path);
            }
            default: {
                auto wheel = Of<WheelJointSettings>(between);
                wheel.isSteered = random_.Chance(0.5f);
                if (random_.Chance(0.5f)) wheel.suspension = RandomControl(random_, 0.5f);
                if (random_.Chance(0.5f)) wheel.steering = RandomControl(random_, 1);
                wheel.spin = RandomControl(random_, 2);
                return Add(wheel);
            }
        }
    }
    // A rod, a rope that is loose, or a spring at its rest length.
    DistanceJointSettings MakeRod(const JointSettings& between) {
        auto rod = Of<DistanceJointSettings>(between);
        if (rod.bodyA != kWorldBody) rod.anchorA.point = NearBody(rod.bodyA, 0.5f);
        rod.anchorB = rod.anchorA;
        do rod.anchorB->point = NearBody(rod.bodyB, 0.5f);
        while ((rod.anchorB->point - rod.anchorA.point).norm() < 0.1);
        const float length = static_cast<float>((rod.anchorB->point - rod.anchorA.point).norm());
        const uint32_t kind = random_.Below(4);
        if (kind == 2) rod.maxDistance = length * (1 + LogBetween(random_, 0.01, 0.5));
        if (kind == 3) rod.spring = RandomSpring(random_, 0);
        return rod;
    }
    // The axis of B anywhere within the cone.
    ConeJointSettings MakeCone(const JointSettings& between) {
        auto cone = Of<ConeJointSettings>(between);
        cone.halfAngle = random_.Between(0.2f, 2.5f);
        cone.spring = RandomSpring(random_, 0.7f);
        const double tilt = static_cast<double>(cone.halfAngle * random_.Between(0, 0.95f));
        const Quaternion turn = RotationAbout(*cone.anchorA.normal, tilt);
        cone.anchorB = cone.anchorA;
        cone.anchorB->axis = Rotate(turn, cone.anchorA.axis);
        return cone;
    }
    SwingTwistJointSettings MakeShoulder(const JointSettings& between) {
        auto shoulder = Of<SwingTwistJointSettings>(between);
        const bool isEllipse = random_.Chance(0.5f);
        shoulder.shape = isEllipse ? SwingShape::Ellipse : SwingShape::Pyramid;
        shoulder.twist = RandomControl(random_, 2);
        shoulder.swingY = RandomControl(random_, 2, isEllipse);
        shoulder.swingZ = RandomControl(random_, 2, isEllipse);
        return shoulder;
    }
    SixDofJointSettings MakeSixDof(const JointSettings& between) {
        auto joint = Of<SixDofJointSettings>(between);
        for (size_t i = 0; i < 6; ++i) {
            joint.axes[i] = random_.Chance(0.45f) ? kLockedAxis : RandomControl(random_, i < 3 ? 1.0f : 2.0f);
            if (random_.Chance(0.1f)) joint.axes[i].limits.spring = RandomSpring(random_, 0);
        }
        return joint;
    }

    void CloseLoops() {
        const uint32_t loops = 1 + random_.Below(3);
        for (uint32_t i = 0; i < loops; ++i) {
            const BodyId a = AnyBody(), b = AnyBody();
            if (a != b) Connect(a, b);
        }
    }
    // A load on a rope; a gear, or a rack and pinion, of two bodies in bearings of their own, one of which is connected
    // to the others.
    void AddTransmissions() {
        const BodyId other = AnyBody();
        if (random_.Chance(0.25f)) {
            const BodyId load = AddBody();
            auto rope = Of<PulleyJointSettings>(Between(other, load));
            rope.anchorB = rope.anchorA;
            rope.anchorA.point = NearBody(rope.bodyA, 0.3f);
            rope.anchorB->point = NearBody(rope.bodyB, 0.3f);
            rope.fixedPointA = rope.anchorA.point + Position(0, 1, 0) + random_.InBox(0.5f).cast<double>();
            rope.fixedPointB = rope.anchorB->point + Position(0, 1, 0) + random_.InBox(0.5f).cast<double>();
            rope.ratio = LogBetween(random_, 0.3, 3);
            Add(rope);
        }
        if (random_.Chance(0.4f)) return;
        const BodyId first = AddBody(), second = AddBody();
        const JointSettings bearing = Between(kWorldBody, first), guide = Between(kWorldBody, second);
        Add(Of<HingeJointSettings>(bearing));
        JointSettings teeth = bearing;
        teeth.bodyA = first;
        teeth.bodyB = second;
        teeth.anchorB = guide.anchorA;
        const float size = LogBetween(random_, 0.2, 5), ratio = random_.Chance(0.5f) ? -size : size;
        if (random_.Chance(0.5f)) {
            Add(Of<HingeJointSettings>(guide));
            auto gear = Of<GearJointSettings>(teeth);
            gear.ratio = ratio;
            Add(gear);
        } else {
            Add(Of<SliderJointSettings>(guide));
            auto rack = Of<RackAndPinionJointSettings>(teeth);
            rack.ratio = ratio;
            Add(rack);
        }
        Connect(other, first);
    }

    template <class Settings>
    void Add(const Settings& settings) {
        structure_.joints.push_back(settings);
    }

    const StructureKind kind_;
    RandomPoses random_;
    Mechanism structure_;
};

}  // namespace

Mechanism RandomStructure(StructureKind kind, uint64_t seed) { return StructureMaker(kind, seed).Make(); }

}  // namespace fulcrum::testing
