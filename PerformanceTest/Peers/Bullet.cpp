// The scenes in Bullet, with its default settings but for the rules by which friction and restitution combine, which
// are ours. One thread: distributions build it without threads.
#include <Fulcrum/PerformanceTest/Peers/Peer.h>

#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <map>
#include <string_view>

namespace fulcrum::BulletPeer {
namespace {

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

class World {
public:
    explicit World(const SceneWorld& ours)
        : ours_(ours), dispatcher_(&configuration_), world_(&dispatcher_, &broadPhase_, &solver_, &configuration_) {
        gCalculateCombinedFrictionCallback = CombineFriction;
        gCalculateCombinedRestitutionCallback = CombineRestitution;
        world_.setGravity(ToBullet(ours.System().Settings().gravity));
        world_.setForceUpdateAllAabbs(false);  // bounds of bodies that do not move stay as they are
        // These two ask for four iterations of any engine.
        const std::string_view name = ours.Definition().name;
        if (name == "convex_on_mesh" || name == "rays") world_.getSolverInfo().m_numIterations = 4;
    }
    ~World() {
        for (const auto& joint : joints_) world_.removeConstraint(joint.get());
        for (const auto& body : bodies_) world_.removeRigidBody(body.get());
    }

    Status Build() {
        std::map<BodyId, const BodySettings*> settings;
        for (const auto& [id, body] : ours_.added) settings[id] = &body;
        const BodySettings usual;  // parts of ragdolls
        Status status = Done{};
        ours_.System().VisitBodies([&](BodyId id) {
            const auto found = settings.find(id);
            if (status) status = AddBody(id, found == settings.end() ? usual : *found->second);
        });
        ours_.Joints().Visit([&](JointId id) {
            if (status) status = AddJoint(id);
        });
        return status;
    }

    void Step(double dt) {
        for (const auto& driver : drivers_) driver->Advance(static_cast<btScalar>(dt));
        world_.stepSimulation(static_cast<btScalar>(dt), 0);
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

    // Puts our bodies where Bullet's are, so that the scene's figure is that of Bullet. Errors: a pose is not finite.
    Status CopyPosesTo(SceneWorld& ours) const {
        for (size_t i = 0; i < bodies_.size(); ++i) {
            if (ours.Bodies().GetMotionType(ids_[i]) == MotionType::Static) continue;
            const btTransform& place = bodies_[i]->getWorldTransform();
            const btQuaternion q = place.getRotation();
            const btVector3 origin = place * -ToBullet(centers_[i]);
            const Status status = ours.Bodies().SetPose(ids_[i], Position(origin.x(), origin.y(), origin.z()),
                                                        Quaternion{q.x(), q.y(), q.z(), q.w()});
            if (!status) return status;
        }
        return Done{};
    }

private:
    // Where a frame of the world is in Bullet's frame of a body.
    btTransform InBody(BodyId id, const btTransform& frame) const {
        return bodies_[index_.at(id)]->getWorldTransform().inverse() * frame;
    }

    Status AddBody(BodyId id, const BodySettings& settings) {
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

        btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, made, inertia);
        info.m_startWorldTransform =
            btTransform(ToBullet(pose.rotation).normalized(), ToBullet(ours.GetCenterOfMass(id)));
        info.m_friction = settings.material.friction;
        info.m_restitution = settings.material.restitution;
        info.m_linearDamping = info.m_angularDamping = 0;
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
        }
        if (ours.GetContinuous(id) != ContinuousCollision::Off) {
            body->setCcdMotionThreshold(shape->InnerRadius());
            body->setCcdSweptSphereRadius(0.9f * shape->InnerRadius());
        }
        const SystemSettings& system = ours_.System().Settings();
        if (motion == MotionType::Kinematic || (motion == MotionType::Dynamic && !system.sleep.enabled))
            body->setActivationState(DISABLE_DEACTIVATION);
        else if (motion == MotionType::Dynamic && settings.startAsleep) body->forceActivationState(ISLAND_SLEEPING);
        // The scenes use layers for bodies that do not collide with each other, and for nothing else.
        if (system.layerCollides[settings.layer] & (1u << settings.layer)) world_.addRigidBody(body.get());
        else world_.addRigidBody(body.get(), btBroadphaseProxy::CharacterFilter << 1, 0);
        index_[id] = bodies_.size();
        ids_.push_back(id);
        centers_.push_back(center);
        bodies_.push_back(std::move(body));
        return Done{};
    }

    Status AddJoint(JointId id) {
        const JointInterface& ours = ours_.Joints();
        const BodyId a = ours.GetBodyA(id), b = ours.GetBodyB(id);
        const auto transform = [](const Pose& frame) {
            return btTransform(ToBullet(frame.rotation).normalized(), ToBullet(frame.position));
        };
        btTransform frameA = transform(ours.GetFrameA(id)), frameB = transform(ours.GetFrameB(id));
        const auto limitsOf = [&](JointAxis axis) { return ours.GetControl(id, axis)->limits; };
        btRigidBody &bodyA = *bodies_[index_.at(a)], &bodyB = *bodies_[index_.at(b)];
        const std::string_view kind = ours.GetType(id)->Kind();
        if (kind == "point") {
            joints_.push_back(std::make_unique<btPoint2PointConstraint>(bodyA, bodyB, InBody(a, frameA).getOrigin(),
                                                                        InBody(b, frameB).getOrigin()));
        } else if (kind == "swing-twist") {
            auto cone = std::make_unique<btConeTwistConstraint>(bodyA, bodyB, InBody(a, frameA), InBody(b, frameB));
            cone->setLimit(limitsOf(JointAxis::AngularY).max, limitsOf(JointAxis::AngularZ).max,
                           limitsOf(JointAxis::AngularX).max);
            joints_.push_back(std::move(cone));
        } else if (kind == "hinge") {
            // Bullet's hinge turns about z, ours about x.
            const btTransform turned(btMatrix3x3(0, 0, 1, 1, 0, 0, 0, 1, 0));
            auto hinge = std::make_unique<btHingeConstraint>(bodyA, bodyB, InBody(a, frameA) * turned,
                                                             InBody(b, frameB) * turned, true);
            const JointLimits limits = limitsOf(JointAxis::AngularX);
            hinge->setLimit(limits.min, limits.max);
            joints_.push_back(std::move(hinge));
        } else {
            return Error{ErrorCode::Unsupported, "a joint of the kind " + std::string(kind)};
        }
        world_.addConstraint(joints_.back().get(), true);
        return Done{};
    }

    static btDefaultCollisionConstructionInfo LargePools() {
        btDefaultCollisionConstructionInfo info;  // no allocation a contact
        info.m_defaultMaxPersistentManifoldPoolSize = info.m_defaultMaxCollisionAlgorithmPoolSize = 65536;
        return info;
    }

    const SceneWorld& ours_;
    Shapes shapes_;
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
    World world(ours);
    const Status built = world.Build();
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
    const bool isFinite = static_cast<bool>(world.CopyPosesTo(ours));
    // The figure of this one is a time.
    if (std::string_view(scene.name) == "mostly_asleep") figures.accuracy = figures.ms.max;
    else if (scene.accuracy)
        figures.accuracy = isFinite ? scene.accuracy(ours) : std::numeric_limits<double>::quiet_NaN();
    return figures;
}

std::string Version() {
    char text[16];
    std::snprintf(text, sizeof text, "%d.%02d", btGetVersion() / 100, btGetVersion() % 100);
    return text;
}

}  // namespace

extern const Peer kPeer{"bullet", Version, Run};

}  // namespace fulcrum::BulletPeer
