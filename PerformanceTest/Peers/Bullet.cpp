// Our worlds in Bullet, with its default settings but for the rules by which friction and restitution combine, which
// are ours. One thread: distributions build it without threads.
#include <Fulcrum/PerformanceTest/Peers/Peer.h>

#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/RoundShapes.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

namespace fulcrum::BulletPeer {
namespace {

constexpr int kIterations = 10;  // Bullet's default

template <class Vector>
btVector3 ToBullet(const Vector& v) {
    return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
btQuaternion ToBullet(const Quaternion& q) { return {q.x, q.y, q.z, q.w}; }

btScalar CombineFriction(const btCollisionObject* a, const btCollisionObject* b) {
    return btSqrt(a->getFriction() * b->getFriction());
}
btScalar CombineRestitution(const btCollisionObject* a, const btCollisionObject* b) {
    return btMax(a->getRestitution(), b->getRestitution());
}

// Which bodies see each other: by our categories, masks and layers. Bodies that are not dynamic never do, as in Bullet.
class Filter final : public btOverlapFilterCallback {
public:
    explicit Filter(const SystemSettings& settings) : layerCollides_(settings.layerCollides) {}

    void Add(const BodySettings& settings) { bodies_.push_back(settings); }
    bool IsNeededFor(const BodySettings& body) const {
        return body.category != 1 || ~body.mask != 0 || ~layerCollides_[body.layer] != 0;
    }
    bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
        const BodySettings &first = Of(*a), &second = Of(*b);
        return (first.motion == MotionType::Dynamic || second.motion == MotionType::Dynamic) &&
               (first.category & second.mask) != 0 && (second.category & first.mask) != 0 &&
               (layerCollides_[first.layer] & (1u << second.layer)) != 0;
    }

private:
    const BodySettings& Of(const btBroadphaseProxy& proxy) const {
        return bodies_[static_cast<size_t>(static_cast<btCollisionObject*>(proxy.m_clientObject)->getUserIndex())];
    }

    const std::array<uint32_t, 32> layerCollides_;
    std::vector<BodySettings> bodies_;  // by user index
};

// Moves a kinematic body at the velocity that it was built with: Bullet asks for its place at each step.
struct Driver final : btMotionState {
    btTransform transform;
    btVector3 linear, angular;

    void Advance(btScalar dt) {
        transform.setOrigin(transform.getOrigin() + linear * dt);
        const btScalar speed = angular.length();
        if (speed > 0) transform.setRotation(btQuaternion(angular / speed, speed * dt) * transform.getRotation());
    }
    void getWorldTransform(btTransform& place) const override { place = transform; }
    void setWorldTransform(const btTransform&) override {}
};

// Owns the data to which Bullet's shapes only point. Shapes are relative to their center of mass, as Bullet requires.
class Shapes {
public:
    // Null if there is no counterpart in Bullet.
    btCollisionShape* Of(const Shape& shape) {
        btCollisionShape*& made = made_[&shape];
        if (!made) made = Make(shape);
        return made;
    }

private:
    template <class T, class... Arguments>
    T* Keep(Arguments&&... arguments) {
        auto kept = std::make_shared<T>(std::forward<Arguments>(arguments)...);
        kept_.push_back(kept);
        return kept.get();
    }

    btCollisionShape* Make(const Shape& shape) {
        switch (shape.Type()) {
            case ShapeType::Sphere: return Keep<btSphereShape>(static_cast<const Sphere&>(shape).Radius());
            case ShapeType::Box: return Keep<btBoxShape>(ToBullet(static_cast<const Box&>(shape).HalfExtents()));
            case ShapeType::Capsule: {
                const auto& capsule = static_cast<const Capsule&>(shape);
                return Keep<btCapsuleShape>(capsule.Radius(), 2 * capsule.HalfHeight());
            }
            case ShapeType::Cylinder: {
                const auto& cylinder = static_cast<const Cylinder&>(shape);
                const float radius = cylinder.TopRadius();
                if (radius != cylinder.BottomRadius()) return nullptr;
                return Keep<btCylinderShape>(btVector3(radius, cylinder.HalfHeight(), radius));
            }
            case ShapeType::Plane: {
                const auto& plane = static_cast<const Plane&>(shape);
                return Keep<btStaticPlaneShape>(ToBullet(plane.Normal()), plane.Offset());
            }
            case ShapeType::ConvexHull: return MakeHull(static_cast<const ConvexHull&>(shape));
            case ShapeType::Compound: return MakeCompound(static_cast<const CompoundShape&>(shape));
            case ShapeType::TriangleMesh: return MakeMesh(static_cast<const TriangleMesh&>(shape));
            default: return nullptr;
        }
    }

    btCollisionShape* MakeHull(const ConvexHull& hull) {
        auto* made = Keep<btConvexHullShape>();
        for (const Vector3& vertex : hull.Vertices()) made->addPoint(ToBullet(vertex), false);
        made->recalcLocalAabb();
        return made;
    }

    btCollisionShape* MakeCompound(const CompoundShape& compound) {
        auto* made = Keep<btCompoundShape>(true, static_cast<int>(compound.Children().size()));
        for (const CompoundShape::Child& child : compound.Children()) {
            btCollisionShape* shape = Of(*child.shape);
            if (!shape) return nullptr;
            made->addChildShape(btTransform(ToBullet(child.pose.rotation), ToBullet(compound.PoseOf(child).position)),
                                shape);
        }
        return made;
    }

    btCollisionShape* MakeMesh(const TriangleMesh& mesh) {
        auto* triangles = Keep<btTriangleMesh>(true, false);
        for (uint32_t id = 0; id < mesh.VertexCount(); ++id)
            triangles->findOrAddVertex(ToBullet(mesh.Vertex(id)), false);
        for (uint32_t id = 0; id < mesh.TriangleCount(); ++id) {
            const TriangleView view = mesh.GetTriangle(id);
            triangles->addTriangleIndices(static_cast<int>(view.vertexIds[0]), static_cast<int>(view.vertexIds[1]),
                                          static_cast<int>(view.vertexIds[2]));
        }
        return Keep<btBvhTriangleMeshShape>(triangles, true);
    }

    std::map<const Shape*, btCollisionShape*> made_;
    std::vector<std::shared_ptr<void>> kept_;
};

// What of these settings has no counterpart; null: nothing.
const char* LacksOf(const BodySettings& body) {
    if (body.isSensor) return "a sensor";
    if (body.group.filter) return "a group of bodies with a filter";
    if (!body.gyroscopicTorque) return "a body without gyroscopic torque";
    if (body.material.frictionRule != CombineRule::GeometricMean ||
        body.material.restitutionRule != CombineRule::Maximum)
        return "a material with a rule of its own";
    return nullptr;
}
const char* LacksOf(const JointSettings& joint) {
    if (std::isfinite(joint.breakForce) || std::isfinite(joint.breakTorque)) return "a joint that breaks";
    return joint.enabled ? nullptr : "a disabled joint";
}

// A distance joint. Bullet has limits and springs along an axis of a body, not between two points, so that the axis is
// turned to the line between these after each step.
struct Distance {
    btGeneric6DofSpring2Constraint* joint;
    btVector3 onA, onB;

    void Aim() const {
        const btTransform &a = joint->getRigidBodyA().getWorldTransform(),
                          &b = joint->getRigidBodyB().getWorldTransform();
        const btVector3 offset = a.getBasis().transpose() * (b * onB - a * onA);
        if (offset.fuzzyZero()) return;
        btVector3 y, z;
        const btVector3 x = offset.normalized();
        btPlaneSpace1(x, y, z);
        joint->setFrames(btTransform(btMatrix3x3(x.x(), y.x(), z.x(), x.y(), y.y(), z.y(), x.z(), y.z(), z.z()), onA),
                         btTransform(btMatrix3x3::getIdentity(), onB));
    }
};

class World final : public PeerWorld {
public:
    World(const PhysicsSystem& ours, int iterations)
        : ours_(ours),
          filter_(ours.Settings()),
          dispatcher_(&configuration_),
          world_(&dispatcher_, &broadPhase_, &solver_, &configuration_) {
        gCalculateCombinedFrictionCallback = CombineFriction;
        gCalculateCombinedRestitutionCallback = CombineRestitution;
        const SystemSettings& settings = ours.Settings();
        world_.setGravity(ToBullet(settings.gravity));
        world_.setForceUpdateAllAabbs(false);  // bounds of bodies that do not move stay as they are
        world_.getSolverInfo().m_numIterations = iterations;
        if (settings.restitutionSpeed != SystemSettings{}.restitutionSpeed)
            world_.getSolverInfo().m_restitutionVelocityThreshold = settings.restitutionSpeed;
    }
    ~World() override {
        for (const auto& joint : joints_) world_.removeConstraint(joint.get());
        for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    }

    Status AddBody(BodyId id, const BodySettings& settings) override {
        if (const char* what = LacksOf(settings)) return Error{ErrorCode::Unsupported, what};
        const BodyInterface& ours = ours_.Bodies();
        const ShapePtr shape = ours.GetShape(id);
        btCollisionShape* made = shapes_.Of(*shape);
        if (!made) return Error{ErrorCode::Unsupported, std::string("a ") + ShapeTypeName(shape->Type())};
        const MotionType motion = ours.GetMotionType(id);
        const Pose pose = ours.GetPose(id);
        const Vector3 center = pose.InverseTransform(ours.GetCenterOfMass(id));
        const btScalar mass = ours.GetMass(id);
        btVector3 inertia(0, 0, 0);
        if (mass > 0) made->calculateLocalInertia(mass, inertia);
        if (mass > 0 && !settings.inertia.isZero(0)) {
            const SymmetricMatrix3 own = ours.GetInertia(id);
            if (std::max({std::abs(own.xy), std::abs(own.xz), std::abs(own.yz)}) > 1e-5f * (own.xx + own.yy + own.zz))
                return Error{ErrorCode::Unsupported, "an inertia whose axes are not the body's"};
            inertia = {own.xx, own.yy, own.zz};
        }

        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, made, inertia);
        info.m_startWorldTransform =
            btTransform(ToBullet(pose.rotation).normalized(), ToBullet(ours.GetCenterOfMass(id)));
        info.m_friction = settings.material.friction;
        info.m_restitution = settings.material.restitution;
        info.m_linearDamping = DampingOf(settings.linearDamping);
        info.m_angularDamping = DampingOf(settings.angularDamping);
        auto body = std::make_unique<btRigidBody>(info);
        body->setUserIndex(static_cast<int>(bodies_.size()));
        const btVector3 linear = ToBullet(ours.GetLinearVelocity(id)), angular = ToBullet(ours.GetAngularVelocity(id));
        if (motion == MotionType::Kinematic) {
            body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
            auto driver = std::make_unique<Driver>();
            driver->transform = info.m_startWorldTransform;
            driver->linear = linear;
            driver->angular = angular;
            body->setMotionState(driver.get());
            drivers_.push_back(std::move(driver));
        } else if (motion == MotionType::Dynamic) {
            body->setLinearVelocity(linear);
            body->setAngularVelocity(angular);
            const auto isFree = [&](LockedAxes axis) {
                return (static_cast<int>(settings.lockedAxes) & static_cast<int>(axis)) == 0 ? 1.0f : 0.0f;
            };
            body->setLinearFactor(
                {isFree(LockedAxes::TranslationX), isFree(LockedAxes::TranslationY), isFree(LockedAxes::TranslationZ)});
            body->setAngularFactor(
                {isFree(LockedAxes::RotationX), isFree(LockedAxes::RotationY), isFree(LockedAxes::RotationZ)});
        }
        if (ours.GetContinuous(id) != ContinuousCollision::Off) {
            body->setCcdMotionThreshold(shape->InnerRadius());
            body->setCcdSweptSphereRadius(0.9f * shape->InnerRadius());
        }
        const bool sleeps = ours_.Settings().sleep.enabled && settings.allowSleep;
        if (motion == MotionType::Kinematic || (motion == MotionType::Dynamic && !sleeps))
            body->setActivationState(DISABLE_DEACTIVATION);
        else if (motion == MotionType::Dynamic && settings.startAsleep) body->forceActivationState(ISLAND_SLEEPING);
        filter_.Add(settings);
        if (filter_.IsNeededFor(settings)) world_.getPairCache()->setOverlapFilterCallback(&filter_);
        world_.addRigidBody(body.get());
        if (settings.gravityFactor != 1)
            body->setGravity(ToBullet(ours_.Settings().gravity) * btScalar(settings.gravityFactor));
        index_[id] = bodies_.size();
        ids_.push_back(id);
        centers_.push_back(center);
        bodies_.push_back(std::move(body));
        return Done{};
    }

    Status AddJoint(JointId id, const JointSettings& settings) override {
        if (const char* what = LacksOf(settings)) return Error{ErrorCode::Unsupported, what};
        const JointInterface& ours = ours_.Joints();
        const BodyId a = ours.GetBodyA(id), b = ours.GetBodyB(id);
        if (a == kWorldBody || b == kWorldBody) return Error{ErrorCode::Unsupported, "a joint to the world"};
        const auto transform = [](const Pose& frame) {
            return btTransform(ToBullet(frame.rotation).normalized(), ToBullet(frame.position));
        };
        const btTransform frameA = InBody(a, transform(ours.GetFrameA(id))),
                          frameB = InBody(b, transform(ours.GetFrameB(id)));
        const auto controlOf = [&](JointAxis axis) { return *ours.GetControl(id, axis); };
        btRigidBody &bodyA = *bodies_[index_.at(a)], &bodyB = *bodies_[index_.at(b)];
        const std::string_view kind = ours.GetType(id)->Kind();
        if (kind == "point") {
            joints_.push_back(
                std::make_unique<btPoint2PointConstraint>(bodyA, bodyB, frameA.getOrigin(), frameB.getOrigin()));
        } else if (kind == "fixed") {
            joints_.push_back(std::make_unique<btFixedConstraint>(bodyA, bodyB, frameA, frameB));
        } else if (kind == "swing-twist") {
            auto cone = std::make_unique<btConeTwistConstraint>(bodyA, bodyB, frameA, frameB);
            cone->setLimit(controlOf(JointAxis::AngularY).limits.max, controlOf(JointAxis::AngularZ).limits.max,
                           controlOf(JointAxis::AngularX).limits.max);
            joints_.push_back(std::move(cone));
        } else if (kind == "cone") {
            const btScalar angle = static_cast<const ConeJoint*>(ours.GetType(id))->HalfAngle();
            auto cone = std::make_unique<btConeTwistConstraint>(bodyA, bodyB, frameA, frameB);
            cone->setLimit(angle, angle, BT_LARGE_FLOAT);
            joints_.push_back(std::move(cone));
        } else if (kind == "hinge") {
            // Bullet's hinge turns about z, ours about x.
            const btTransform turned(btMatrix3x3(0, 0, 1, 1, 0, 0, 0, 1, 0));
            auto hinge = std::make_unique<btHingeConstraint>(bodyA, bodyB, frameA * turned, frameB * turned, true);
            const AxisControl control = controlOf(JointAxis::AngularX);
            if (!IsPlain(control)) return Error{ErrorCode::Unsupported, "a hinge with a motor, friction or a spring"};
            if (control.limited) hinge->setLimit(control.limits.min, control.limits.max);
            joints_.push_back(std::move(hinge));
        } else if (kind == "slider") {
            const AxisControl control = controlOf(JointAxis::LinearX);
            auto slider = std::make_unique<btSliderConstraint>(bodyA, bodyB, frameA, frameB, true);
            if (control.limited) {
                slider->setLowerLinLimit(control.limits.min);
                slider->setUpperLinLimit(control.limits.max);
            }
            if (const char* what = SetMotor(*slider, control)) return Error{ErrorCode::Unsupported, what};
            joints_.push_back(std::move(slider));
        } else if (kind == "distance") {
            auto rod = std::make_unique<btGeneric6DofSpring2Constraint>(bodyA, bodyB, frameA, frameB);
            for (int axis = 1; axis < 6; ++axis) rod->setLimit(axis, 1, -1);  // free
            const JointLimits limits = controlOf(JointAxis::LinearX).limits;
            distances_.push_back({rod.get(), frameA.getOrigin(), frameB.getOrigin()});
            distances_.back().Aim();
            if (IsHard(limits.spring)) {
                rod->setLimit(0, limits.min, std::min(limits.max, float(BT_LARGE_FLOAT)));
            } else if (limits.min == limits.max && limits.spring.mode == SpringMode::FrequencyAndDamping) {
                // The mass that the spring moves: as our rows have it.
                const btVector3 onA = bodyA.getWorldTransform() * frameA.getOrigin(),
                                onB = bodyB.getWorldTransform() * frameB.getOrigin(), along = (onB - onA).normalized();
                const btScalar w = 2 * SIMD_PI * limits.spring.frequency,
                               mass = 1 / (bodyA.computeImpulseDenominator(onA, along) +
                                           bodyB.computeImpulseDenominator(onB, along));
                rod->setLimit(0, 1, -1);
                rod->enableSpring(0, true);
                rod->setStiffness(0, w * w * mass);
                rod->setDamping(0, 2 * limits.spring.dampingRatio * w * mass);
                rod->setEquilibriumPoint(0, limits.min);
            } else {
                return Error{ErrorCode::Unsupported, "a rope with a spring"};
            }
            joints_.push_back(std::move(rod));
        } else {
            return Error{ErrorCode::Unsupported, "a joint of the kind " + std::string(kind)};
        }
        world_.addConstraint(joints_.back().get(), !settings.collideConnected);
        return Done{};
    }

    // Without settings of ours, which parts of ragdolls have not kept: the usual ones.
    Status Build(const SceneWorld& scene) {
        std::map<BodyId, const BodySettings*> settings;
        for (const auto& [id, body] : scene.added) settings[id] = &body;
        Status status = Done{};
        ours_.VisitBodies([&](BodyId id) {
            const auto found = settings.find(id);
            if (status) status = AddBody(id, found == settings.end() ? BodySettings{} : *found->second);
        });
        ours_.Joints().Visit([&](JointId id) {
            if (status) status = AddJoint(id, JointSettings{});
        });
        return status;
    }

    void Step(double dt) override {
        for (const auto& driver : drivers_) driver->Advance(static_cast<btScalar>(dt));
        world_.stepSimulation(static_cast<btScalar>(dt), 0);
        for (const Distance& distance : distances_) distance.Aim();
    }

    // Index of the ray's nearest hit among the bodies, or none.
    std::optional<BodyId> CastRay(const Ray& ray) const {
        const btVector3 from = ToBullet(ray.origin),
                        to = ToBullet(Position(ray.origin + ray.displacement.cast<double>()));
        btCollisionWorld::ClosestRayResultCallback hit(from, to);
        world_.rayTest(from, to, hit);
        if (!hit.hasHit()) return std::nullopt;
        return ids_[static_cast<size_t>(hit.m_collisionObject->getUserIndex())];
    }

    Status CopyTo(PhysicsSystem& ours) override {
        moving_.clear();
        poses_.clear();
        asleep_.clear();
        BodyInterface& bodies = ours.Bodies();
        for (size_t i = 0; i < bodies_.size(); ++i) {
            const btRigidBody& body = *bodies_[i];
            if (bodies.GetMotionType(ids_[i]) == MotionType::Static) continue;
            const btTransform& place = body.getWorldTransform();
            const btQuaternion q = place.getRotation();
            const btVector3 origin = place * -ToBullet(centers_[i]);
            moving_.push_back(ids_[i]);
            poses_.push_back({Position(origin.x(), origin.y(), origin.z()), Quaternion{q.x(), q.y(), q.z(), q.w()}});
            if (!body.isActive()) asleep_.push_back(ids_[i]);
            const btVector3 &v = body.getLinearVelocity(), &w = body.getAngularVelocity();
            const Status status =
                bodies.SetVelocity(ids_[i], Vector3(v.x(), v.y(), v.z()), Vector3(w.x(), w.y(), w.z()));
            if (!status) return status;
        }
        if (const Status status = bodies.SetPoses(moving_, poses_); !status) return status;
        for (const BodyId id : asleep_) (void)bodies.Sleep(id);
        return Done{};
    }

private:
    // Where a frame of the world is in Bullet's frame of a body.
    btTransform InBody(BodyId id, const btTransform& frame) const {
        return bodies_[index_.at(id)]->getWorldTransform().inverse() * frame;
    }

    // Ours is v' = -damping v, Bullet's takes this part of the velocity each second.
    static btScalar DampingOf(float damping) { return -std::expm1(-damping); }

    static bool IsPlain(const AxisControl& control) {
        return control.motor.mode == MotorMode::Off && control.friction == 0 &&
               (!control.limited || IsHard(control.limits.spring));
    }

    // A motor to a speed, or friction, which is one to the speed zero. Returns what has no counterpart, or null.
    static const char* SetMotor(btSliderConstraint& slider, const AxisControl& control) {
        const JointMotor& motor = control.motor;
        const bool isOn = motor.mode != MotorMode::Off;
        if (control.limited && !IsHard(control.limits.spring)) return "a slider with soft limits";
        if (motor.mode == MotorMode::ToPosition || (isOn && motor.minForce != -motor.maxForce))
            return "a slider with such a motor";
        if (isOn && control.friction > 0) return "a slider with a motor and friction";
        if (!isOn && control.friction == 0) return nullptr;
        slider.setPoweredLinMotor(true);
        slider.setTargetLinMotorVelocity(isOn ? motor.targetSpeed : 0);
        slider.setMaxLinMotorForce(isOn ? motor.maxForce : control.friction);
        return nullptr;
    }

    static btDefaultCollisionConstructionInfo LargePools() {
        btDefaultCollisionConstructionInfo info;  // no allocation a contact
        info.m_defaultMaxPersistentManifoldPoolSize = info.m_defaultMaxCollisionAlgorithmPoolSize = 65536;
        return info;
    }

    const PhysicsSystem& ours_;
    Shapes shapes_;
    Filter filter_;
    btDefaultCollisionConfiguration configuration_{LargePools()};
    btCollisionDispatcher dispatcher_;
    btDbvtBroadphase broadPhase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_;
    std::vector<std::unique_ptr<Driver>> drivers_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_;
    std::vector<BodyId> ids_;       // by body
    std::vector<Vector3> centers_;  // likewise, in the user's frame
    std::map<BodyId, size_t> index_;
    std::vector<std::unique_ptr<btTypedConstraint>> joints_;
    std::vector<Distance> distances_;
    std::vector<BodyId> moving_, asleep_;  // of CopyTo
    std::vector<Pose> poses_;              // likewise
};

template <class Function>
double MsOf(Function&& function) {
    const auto begin = std::chrono::steady_clock::now();
    function();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

Result<PeerFigures> Run(const Scene& scene, SceneInput input, int untimed, int steps, double dt) {
    if (scene.beforeStep) return Error{ErrorCode::Unsupported, "it acts between steps"};
    input.keepsSettings = true;
    const auto created = SceneWorld::Create(scene, input);
    if (!created) return created.GetError();
    SceneWorld& ours = *created.Value();
    if (scene.query && ours.rays.empty()) return Error{ErrorCode::Unsupported, "its queries"};
    // These two ask for four iterations of any engine.
    const std::string_view name = scene.name;
    World world(ours.System(), name == "convex_on_mesh" || name == "rays" ? 4 : kIterations);
    const Status built = world.Build(ours);
    if (!built) return built.GetError();

    std::vector<double> ms;
    for (int step = 0; step < untimed + steps; ++step) {
        const double time = MsOf([&] { world.Step(dt); });
        if (step >= untimed) ms.push_back(time);
    }
    if (scene.query) {
        ms.clear();
        for (int batch = 0; batch <= 5; ++batch) {
            const double time = MsOf([&] {
                for (size_t i = 0; i < ours.rays.size(); ++i)
                    ours.rayHits[i].body = world.CastRay(ours.rays[i]).value_or(BodyId{});
            });
            if (batch > 0) ms.push_back(time);
        }
    }
    PeerFigures figures;
    figures.ms = Summarize(std::move(ms));
    const bool isFinite = static_cast<bool>(world.CopyTo(ours.System()));
    // The figure of this one is a time.
    if (name == "mostly_asleep") figures.accuracy = figures.ms.max;
    else if (scene.accuracy)
        figures.accuracy = isFinite ? scene.accuracy(ours) : std::numeric_limits<double>::quiet_NaN();
    return figures;
}

std::unique_ptr<PeerWorld> Create(const PhysicsSystem& ours, int iterations) {
    return std::make_unique<World>(ours, iterations);
}

std::string Version() {
    char text[16];
    std::snprintf(text, sizeof text, "%d.%02d", btGetVersion() / 100, btGetVersion() % 100);
    return text;
}

}  // namespace

extern const Peer kPeer{"bullet", "Bullet", Version, kIterations, Create, Run};

}  // namespace fulcrum::BulletPeer
