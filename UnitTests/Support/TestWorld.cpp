#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Math/Trigonometry.h>

#include <cmath>

namespace fulcrum::testing {

namespace {

template <class T>
ShapePtr Checked(Result<T> shape) {
    if (shape) return shape.Value();
    ADD_FAILURE() << shape.GetError().message;
    return nullptr;
}

}  // namespace

ShapePtr SphereOf(float radius) { return Checked(Sphere::Create(radius)); }
ShapePtr BoxOf(float halfX, float halfY, float halfZ) { return Checked(Box::Create(Vector3(halfX, halfY, halfZ))); }
ShapePtr CapsuleOf(float halfHeight, float radius) { return Checked(Capsule::Create(halfHeight, radius)); }
ShapePtr HullOf(std::initializer_list<Vector3> points) {
    return Checked(ConvexHull::Create(std::span<const Vector3>(points.begin(), points.size())));
}
ShapePtr CompoundOf(std::initializer_list<Compound::ChildSettings> children) {
    return Checked(Compound::Create(std::span<const Compound::ChildSettings>(children.begin(), children.size())));
}

TestWorld::TestWorld(const SystemSettings& settings, uint32_t threads) {
    if (threads > 1) jobs_ = std::make_unique<ThreadPool>(threads);
    Result<std::unique_ptr<PhysicsSystem>> system = PhysicsSystem::Create(settings, jobs_.get());
    if (system) system_ = std::move(system.Value());
    else ADD_FAILURE() << system.GetError().message;
}

BodyId TestWorld::Add(const BodySettings& settings) {
    const Result<BodyId> id = Bodies().Create(settings);
    if (id) return id.Value();
    ADD_FAILURE() << id.GetError().message;
    return {};
}

BodyId TestWorld::AddFloor(const Material& material, const Position& origin) {
    return Add({.shape = BoxOf(100, 1, 100),
                .motion = MotionType::Static,
                .position = origin - Position(0, 1, 0),
                .material = material});
}

void TestWorld::Step(double dt) {
    const Status status = system_->Update(dt);
    if (!status) ADD_FAILURE() << status.GetError().message;
}

void TestWorld::Steps(int count, double dt) {
    for (int i = 0; i < count; ++i) Step(dt);
}

void TestWorld::Run(double seconds, double dt) { Steps(static_cast<int>(std::lround(seconds / dt)), dt); }

double TestWorld::ImpulseBetween(BodyId a, BodyId b) {
    double sum = 0;
    system_->VisitContacts([&](const ContactView& contact) {
        const bool between = (contact.bodyA == a && contact.bodyB == b) || (contact.bodyA == b && contact.bodyB == a);
        if (!between) return;
        for (const ContactView::Point& point : contact.points) sum += double(point.impulse);
    });
    return sum;
}

double TestWorld::ForceBetween(BodyId a, BodyId b, double dt) {
    return ImpulseBetween(a, b) * system_->Settings().solver.substeps / dt;
}

bool TestWorld::AllFinite() {
    bool finite = true;
    system_->VisitBodies([&](BodyId id) {
        const Pose pose = Bodies().GetPose(id);
        finite = finite && IsFinite(pose.position) && IsFinite(pose.rotation) &&
                 IsFinite(Bodies().GetLinearVelocity(id)) && IsFinite(Bodies().GetAngularVelocity(id)) &&
                 !Bodies().IsFrozen(id);
    });
    return finite;
}

SystemSettings NoGravity() {
    SystemSettings settings;
    settings.gravity = Vector3::Zero();
    return settings;
}

SystemSettings NoSleep() {
    SystemSettings settings;
    settings.sleep.enabled = false;
    return settings;
}

BodyBits BitsOf(TestWorld& world, BodyId id) {
    const Pose pose = world.Bodies().GetPose(id);
    const Vector3 v = world.Bodies().GetLinearVelocity(id), w = world.Bodies().GetAngularVelocity(id);
    const Quaternion& q = pose.rotation;
    return {{pose.position.x(), pose.position.y(), pose.position.z()},
            {q.x, q.y, q.z, q.w},
            {v.x(), v.y(), v.z()},
            {w.x(), w.y(), w.z()}};
}

}  // namespace fulcrum::testing
