// A call that runs out of memory has had no effect: whichever of its requests fails, the world is as one in which the
// call was never made, and the call can be made afterwards.
#include <Fulcrum/Physics/Fields/Fields.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/UnitTests/Support/FailingMemory.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <functional>
#include <string>

namespace fulcrum::testing {
namespace {

// Shapes are not in the world's memory.
struct Parts {
    ShapePtr floor = BoxOf(50, 0.5f, 50), cube = CubeOf(0.3f), ball = SphereOf(0.3f), slab = BoxOf(1, 0.1f, 1),
             pair = CompoundOf({{.shape = CubeOf(0.2f)}, {.shape = SphereOf(0.3f), .position = {0.4f, 0, 0}}});
    ShapePtr edited =
        MutableCompound::Create(std::vector<CompoundShape::ChildSettings>{
                                    {.shape = CubeOf(0.2f)}, {.shape = CubeOf(0.2f), .position = {0.5f, 0, 0}}})
            .Value();
};

SystemSettings AllEvents() {
    SystemSettings settings;
    settings.events.contacts = settings.events.bodies = true;
    return settings;
}

// Bodies awake and asleep, joined and in contact, a sensor, a kinematic one. `more`: bodies that bring lists to other
// lengths, so that one or the other is full.
struct SmallWorld {
    SmallWorld(const Parts& itsParts, MemoryResource* memory, int more)
        : parts(itsParts), system(PhysicsSystem::Create(AllEvents(), nullptr, memory).Value()) {
        BodyInterface& bodies = system->Bodies();
        const auto add = [&](const BodySettings& settings) { return bodies.Create(settings).Value(); };
        add({.shape = parts.floor, .motion = MotionType::Static, .position = {0, -0.5, 0}});
        for (int i = 0; i < 3; ++i) {
            stack[i] = add({.shape = parts.cube, .position = {0, 0.3 + 0.6 * i, 0}});
            asleep[i] = add({.shape = parts.cube, .position = {3, 0.3 + 0.6 * i, 0}, .startAsleep = true});
        }
        for (int i = 0; i < 2; ++i) {
            HingeJointSettings hinge;
            hinge.bodyA = asleep[i];
            hinge.bodyB = asleep[i + 1];
            hinge.anchorA.point = {3, 0.6 + 0.6 * i, 0};
            hinges[i] = system->Joints().Create(hinge).Value();
        }
        edited = add({.shape = parts.edited, .position = {-3, 0.2, 0}});
        platform = add({.shape = parts.slab, .motion = MotionType::Kinematic, .position = {0, 0.1, 6}});
        passenger = add({.shape = parts.ball, .position = {0, 0.5, 6}, .category = 2});
        sensor = add({.shape = parts.slab, .motion = MotionType::Static, .position = {0, 0.2, 0}, .isSensor = true});
        for (int i = 0; i < more; ++i)
            add({.shape = parts.ball, .position = {10.0 + i, 0.3, 0}, .startAsleep = i % 2 == 0});
        Steps(2);
        for (const BodyId id : asleep) (void)bool(bodies.Sleep(id));
    }
    void Steps(int count) {
        for (int i = 0; i < count; ++i) ASSERT_TRUE(system->Update(kStep));
    }

    const Parts& parts;
    std::unique_ptr<PhysicsSystem> system;
    BodyId stack[3], asleep[3], edited, platform, passenger, sensor;
    JointId hinges[2];
};

struct Call {
    std::string name;
    std::function<bool(SmallWorld&)> make;  // whether it was done
};

class AllowAll final : public ContactListener {};

std::vector<BodySettings> TwoBodies(const Parts& parts) {
    return {{.shape = parts.cube, .position = {0, 3, 0}}, {.shape = parts.pair, .position = {1, 3, 0}}};
}

RagdollSettings TwoParts(const Parts& parts) {
    RagdollSettings settings;
    settings.parts.resize(2);
    settings.parts[0].name = "hips";
    settings.parts[1].name = "chest";
    settings.parts[0].body = {.shape = parts.cube, .position = {0, 4, 0}};
    settings.parts[1].body = {.shape = parts.cube, .position = {0, 4.6, 0}};
    settings.parts[1].parent = 0;
    return settings;
}

std::vector<Call> CallsThatCreate() {
    const auto create = [](const auto& settingsOf) {
        return [=](SmallWorld& w) { return bool(w.system->Bodies().Create(settingsOf(w))); };
    };
    static const AllowAll kListener;
    return {
        {"a dynamic body", create([](SmallWorld& w) {
             return BodySettings{.shape = w.parts.cube, .position = {0, 5, 0}};
         })},
        {"a compound that sleeps", create([](SmallWorld& w) {
             return BodySettings{.shape = w.parts.pair, .position = {5, 5, 0}, .startAsleep = true};
         })},
        {"a mutable compound with a filter", create([](SmallWorld& w) {
             return BodySettings{.shape = w.parts.edited, .position = {0, 5, 0}, .category = 4};
         })},
        {"a static body of a mass", create([](SmallWorld& w) {
             return BodySettings{.shape = w.parts.cube, .motion = MotionType::Static, .position = {9, 5, 0}, .mass = 7};
         })},
        {"a sensor", create([](SmallWorld& w) {
             return BodySettings{
                 .shape = w.parts.cube, .motion = MotionType::Static, .position = {3, 1, 0}, .isSensor = true};
         })},
        {"Commit",
         [](SmallWorld& w) {
             HingeJointSettings inside;
             inside.bodyA = BodyBatch::Body(0);
             inside.bodyB = BodyBatch::Body(1);
             PointJointSettings toWorld;
             toWorld.bodyA = kWorldBody;
             toWorld.bodyB = w.asleep[0];
             return bool(w.system->Bodies().Commit(BodyBatch::Prepare(TwoBodies(w.parts), {inside, toWorld}).Value()));
         }},
        {"a joint of sleepers",
         [](SmallWorld& w) {
             PointJointSettings joint;
             joint.bodyA = w.asleep[0];
             joint.bodyB = w.asleep[2];
             return bool(w.system->Joints().Create(joint));
         }},
        {"a joint of a pair in contact",
         [](SmallWorld& w) {
             PointJointSettings joint;
             joint.bodyA = w.stack[0];
             joint.bodyB = w.stack[1];
             return bool(w.system->Joints().Create(joint));
         }},
        {"a joint to the world",
         [](SmallWorld& w) {
             return bool(
                 w.system->Joints().CreateTarget({.body = w.stack[2], .anchor = {0, 1.5, 0}, .target = {0, 2, 0}}));
         }},
        {"a ragdoll",
         [](SmallWorld& w) {
             return bool(Ragdoll::Create(*w.system, TwoParts(w.parts), {{0, 2, 0}, {}}));
         }},
        {"SetContactListener",
         [](SmallWorld& w) {
             w.system->SetContactListener(&kListener);
             return true;
         }},
    };
}

std::vector<Call> CallsOfBodies() {
    const auto of = [](const auto& call) { return [=](SmallWorld& w) { return bool(call(w, w.system->Bodies())); }; };
    using W = SmallWorld;
    using B = BodyInterface;
    return {
        {"Remove", of([](W& w, B& b) { return b.Remove(w.stack[1]); })},
        {"Remove a sleeper", of([](W& w, B& b) { return b.Remove(w.asleep[1]); })},
        {"Remove a sensor", of([](W& w, B& b) { return b.Remove(w.sensor); })},
        {"MoveKinematic", of([](W& w, B& b) {
             return b.MoveKinematic(w.platform, {0.1, 0.1, 6}, {}, 1.0f / 60);
         })},
        {"SetVelocity", of([](W& w, B& b) {
             return b.SetVelocity(w.asleep[0], {1, 0, 0}, {});
         })},
        {"SetVelocity of a kinematic body", of([](W& w, B& b) {
             return b.SetVelocity(w.platform, {1, 0, 0}, {});
         })},
        {"AddForce", of([](W& w, B& b) {
             return b.AddForce(w.asleep[2], {10, 0, 0});
         })},
        {"AddImpulseAt", of([](W& w, B& b) {
             return b.AddImpulseAt(w.asleep[2], {10, 0, 0}, {3, 2, 0});
         })},
        {"AddRadialImpulse", of([](W&, B& b) {
             return b.AddRadialImpulse({.center = {2, 0, 0}, .radius = 3, .impulse = 20});
         })},
        {"SetSensor", of([](W& w, B& b) { return b.SetSensor(w.stack[1], true); })},
        {"SetSensor off", of([](W& w, B& b) { return b.SetSensor(w.sensor, false); })},
        {"SetSensorSees", of([](W& w, B& b) { return b.SetSensorSees(w.sensor, SensorSees::Nothing); })},
        {"Wake", of([](W& w, B& b) { return b.Wake(w.asleep[0]); })},
        {"Sleep", of([](W& w, B& b) { return b.Sleep(w.stack[0]); })},
        {"SetMotionType", of([](W& w, B& b) { return b.SetMotionType(w.asleep[1], MotionType::Static); })},
        {"SetMotionType to dynamic", of([](W& w, B& b) { return b.SetMotionType(w.platform, MotionType::Dynamic); })},
        {"SetMass", of([](W& w, B& b) { return b.SetMass(w.asleep[1], 3); })},
        {"SetMass of a kinematic body", of([](W& w, B& b) { return b.SetMass(w.platform, 3); })},
        {"SetPose", of([](W& w, B& b) {
             return b.SetPose(w.asleep[2], {-1, 3, 0}, {});
         })},
        {"SetPoses", of([](W& w, B& b) {
             const BodyId ids[] = {w.asleep[0], w.stack[2], w.sensor};
             const Pose poses[] = {{{-1, 3, 0}, {}}, {{3, 3, 0}, {}}, {{5, 0, 0}, {}}};
             return b.SetPoses(ids, poses);
         })},
        {"SetMaterial", of([](W& w, B& b) { return b.SetMaterial(w.asleep[0], {.friction = 0.1f}); })},
        {"SetLayer", of([](W& w, B& b) { return b.SetLayer(w.stack[1], 3); })},
        {"SetCategoryAndMask", of([](W& w, B& b) { return b.SetCategoryAndMask(w.stack[1], 2, 2); })},
        {"SetGroup", of([](W& w, B& b) {
             static const auto kFilter = GroupFilterTable::Create({{1, 1}}).Value();
             return b.SetGroup(w.asleep[1], {.filter = kFilter, .group = 1, .subGroup = 1});
         })},
        {"SetGravityFactor", of([](W& w, B& b) { return b.SetGravityFactor(w.asleep[0], 0.5f); })},
        {"SetGravity", of([](W& w, B& b) { return b.SetGravity(w.asleep[0], Vector3(0, 1, 0)); })},
        {"SetLockedAxes", of([](W& w, B& b) { return b.SetLockedAxes(w.asleep[0], LockedAxes::Rotation); })},
        {"SetAllowSleep", of([](W& w, B& b) { return b.SetAllowSleep(w.asleep[0], false); })},
        {"SetPenetrationTarget", of([](W& w, B& b) { return b.SetPenetrationTarget(w.stack[0], 0.001f); })},
        {"SetShape", of([](W& w, B& b) { return b.SetShape(w.asleep[1], w.parts.pair); })},
        {"SetShape to one that can be edited", of([](W& w, B& b) { return b.SetShape(w.stack[1], w.parts.edited); })},
        {"SetShape of one that can be edited", of([](W& w, B& b) { return b.SetShape(w.edited, w.parts.cube); })},
        {"AddChild", of([](W& w, B& b) {
             return b.AddChild(w.edited, {.shape = w.parts.cube, .position = {1, 0, 0}});
         })},
        {"MoveChild", of([](W& w, B& b) {
             return b.MoveChild(w.edited, {1, 0}, {0.7f, 0, 0}, {});
         })},
        {"RemoveChild", of([](W& w, B& b) {
             return b.RemoveChild(w.edited, {1, 0});
         })},
    };
}

std::vector<Call> OtherCalls() {
    const auto of = [](const auto& call) { return [=](SmallWorld& w) { return bool(call(w, w.system->Joints())); }; };
    using W = SmallWorld;
    using J = JointInterface;
    const auto withSettings = [](const auto& change) {
        return [=](W& w) {
            SystemSettings settings = w.system->Settings();
            change(settings);
            return bool(w.system->SetSettings(settings));
        };
    };
    return {
        {"remove a joint", of([](W& w, J& j) { return j.Remove(w.hinges[0]); })},
        {"disable a joint", of([](W& w, J& j) { return j.SetEnabled(w.hinges[1], false); })},
        {"SetLimits", of([](W& w, J& j) {
             return j.SetLimits(w.hinges[0], JointAxis::AngularX, JointLimits{-1, 1});
         })},
        {"SetMotor", of([](W& w, J& j) {
             return j.SetMotor(w.hinges[0], JointAxis::AngularX, {.mode = MotorMode::ToVelocity, .targetSpeed = 1});
         })},
        {"SetMassOverride of a joint",
         of([](W& w, J& j) { return j.SetMassOverride(w.hinges[0], {.inverseMassScaleA = 0.5f}); })},
        {"SetEffort", of([](W& w, J& j) { return j.SetEffort(w.hinges[0], {.substeps = 8}); })},
        {"layers", withSettings([](SystemSettings& s) { s.layerCollides[0] &= ~1u; })},
        {"events off", withSettings([](SystemSettings& s) { s.events = {}; })},
        {"gravity", withSettings([](SystemSettings& s) {
             s.gravity = {0, -1, 0};
         })},
        {"accuracy", withSettings([](SystemSettings& s) { s.accuracy.penetration = 0.001f; })},
        {"fields",
         [](W& w) {
             Fields fields;
             fields.winds = {{.velocity = {3, 0, 0}}};
             return bool(fields.Apply(*w.system, kStep));
         }},
        {"SaveBodies and RestoreBodies",
         [](W& w) {
             std::vector<std::byte> bytes;
             const std::vector<BodyId> ids(std::begin(w.asleep), std::end(w.asleep));
             return w.system->SaveBodies(ids, bytes) && w.system->RestoreBodies(bytes);
         }},
        {"SaveSnapshot",
         [](W& w) {
             std::vector<std::byte> bytes;
             return bool(w.system->SaveSnapshot(bytes));
         }},
        {"queries",
         [](W& w) {
             std::vector<WorldContact> contacts;
             std::vector<OverlapHit> hits;
             w.system->Queries().CollideShape({w.parts.cube.get(), {{0, 0.2, 0}, {}}}, 0.1f, contacts);
             w.system->Queries().FindOverlaps({w.parts.cube.get(), {{0, 0.2, 0}, {}}}, hits);
             w.system->VisitIslands([](BodyId, uint32_t) {});
             w.system->VisitContactsOf(w.stack[0], [](const ContactView&) {});
             return w.system->HashState() != 0;
         }},
    };
}

// Each request of the call fails once, in a world of its own. The hash of a world takes memory, too: it is taken when
// there is enough again.
void ExpectNoEffect(const Parts& parts, const Call& call, int more) {
    SmallWorld never(parts, nullptr, more), made(parts, nullptr, more);
    const uint64_t before = never.system->HashState();
    ASSERT_TRUE(call.make(made)) << call.name;
    const uint64_t after = made.system->HashState();
    made.Steps(3);
    never.Steps(3);
    for (int64_t n = 1;; ++n) {
        const std::string where = call.name + ", request " + std::to_string(n);
        ASSERT_LT(n, 200) << where;
        FailingMemory memory;
        bool isDone = false;
        {
            SmallWorld world(parts, &memory, more);
            memory.FailAt(n);
            try {
                isDone = call.make(world);
            } catch (const std::bad_alloc&) {}
            // What can wait is asked for again later: the call is done.
            ASSERT_TRUE(isDone || memory.HasFailed()) << where;
            const bool isLast = !memory.HasFailed();
            memory.FailAt(0);
            ASSERT_EQ(world.system->HashState(), isDone ? after : before) << where;
            // It goes on as a world in which it was never made; of every other one, makes it now.
            if (!isDone && n % 2 == 0) {
                isDone = call.make(world);
                ASSERT_TRUE(isDone) << where;
            }
            world.Steps(3);
            ASSERT_EQ(world.system->HashState(), (isDone ? made : never).system->HashState()) << where;
            if (isLast) return;
        }
        ASSERT_EQ(memory.Bytes(), 0) << where;
    }
}

void ExpectNoEffect(const std::vector<Call>& calls) {
    const Parts parts;
    int more = 0;
    for (const Call& call : calls) {
        ExpectNoEffect(parts, call, more);
        more = (more + 3) % 8;
    }
}

TEST(OutOfMemoryCalls, CreatesNothing) { ExpectNoEffect(CallsThatCreate()); }
TEST(OutOfMemoryCalls, ChangesNoBody) { ExpectNoEffect(CallsOfBodies()); }
TEST(OutOfMemoryCalls, ChangesNothingElse) { ExpectNoEffect(OtherCalls()); }

// Lists become full one after the other: the next body, whichever it is, is there or is not.
TEST(OutOfMemoryCalls, AWorldThatGrows) {
    const Parts parts;
    FailingMemory memory;
    SmallWorld world(parts, &memory, 0), twin(parts, nullptr, 0);
    for (int i = 0; i < 150; ++i) {
        BodySettings settings{.shape = i % 3 == 0 ? parts.pair : parts.ball,
                              .motion = i % 5 == 0 ? MotionType::Static : MotionType::Dynamic,
                              .position = {20.0 + i, 1, 0},
                              .startAsleep = i % 2 == 0 && i % 5 != 0,
                              .isSensor = i % 5 == 0};
        BodyId id;
        for (int64_t n = 1; id == BodyId{}; ++n) {
            memory.FailAt(n);
            try {
                id = world.system->Bodies().Create(settings).Value();
            } catch (const std::bad_alloc&) {}
        }
        memory.FailAt(0);
        EXPECT_EQ(id, twin.system->Bodies().Create(settings).Value());
        PointJointSettings joint;
        joint.bodyA = kWorldBody;
        joint.bodyB = id;
        joint.anchorA.point = settings.position;
        const bool isJoined = i % 4 == 1 && i % 5 != 0;
        JointId made;
        for (int64_t n = 1; isJoined && made == JointId{}; ++n) {
            memory.FailAt(n);
            try {
                made = world.system->Joints().Create(joint).Value();
            } catch (const std::bad_alloc&) {}
        }
        memory.FailAt(0);
        if (isJoined) {
            EXPECT_EQ(made, twin.system->Joints().Create(joint).Value());
        }
    }
    EXPECT_EQ(world.system->HashState(), twin.system->HashState());
    world.Steps(2);
    twin.Steps(2);
    EXPECT_EQ(world.system->HashState(), twin.system->HashState());
}

}  // namespace
}  // namespace fulcrum::testing
