// A frozen body kept the velocity that its contact rows gave it, NaN included, which spread from body to body, until a
// rebuild of a tree read out of bounds. Here NaN and infinity are written over every number of the bodies' state, of
// contacts, joints and their impulses, one at a time.
#include <Fulcrum/UnitTests/Support/Cases.h>
#include <Fulcrum/UnitTests/Support/WorldAccess.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace fulcrum::testing {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// A heap, a platform that moves through it, a chain, a motor, a wheel, and what rests on a mesh-like compound.
struct Scene {
    TestWorld world{NoSleep()};
    std::vector<BodyId> bodies;
    BodyId spoiled, platform;

    BodyId Add(const BodySettings& settings) {
        bodies.push_back(world.Add(settings));
        return bodies.back();
    }

    Scene() {
        world.AddFloor({.restitution = 0.2f});
        platform = Add({.shape = BoxOf(0.3f, 0.2f, 2),
                        .motion = MotionType::Kinematic,
                        .position = {-2, 0.2, 0},
                        .linearVelocity = {0.5f, 0, 0},
                        .angularVelocity = {0, 0.3f, 0}});
        const ShapePtr dumbbell = CompoundOf(
            {{.shape = CubeOf(0.2f), .position = {-0.4f, 0, 0}}, {.shape = SphereOf(0.25f), .position = {0.4f, 0, 0}}});
        spoiled = Add({.shape = BoxOf(0.4f, 0.3f, 0.5f), .position = {0, 0.3, 0}});
        Add({.shape = BoxOf(0.4f, 0.3f, 0.5f), .position = {0.1, 0.9, 0}});
        Add({.shape = CubeOf(0.3f), .position = {0, 1.55, 0.1}, .continuous = ContinuousCollision::LinearAndAngular});
        Add({.shape = SphereOf(0.3f), .position = {0.7, 0.3, 0}});
        Add({.shape = CapsuleOf(0.3f, 0.2f), .position = {-0.7, 0.6, 0}});
        Add({.shape = dumbbell, .position = {0, 2.2, 0}});
        BodyId before = spoiled;
        for (int i = 0; i < 4; ++i) {
            const BodyId link = Add({.shape = CapsuleOf(0.1f, 0.08f),
                                     .position = {0.6 + 0.3 * i, 0.5, 0.9},
                                     .rotation = RotationAbout({0, 0, 1}, kPi / 2)});
            Join(world, Of<PointJointSettings>(Between(before, link, {0.45 + 0.3 * i, 0.5, 0.9})));
            before = link;
        }
        const BodyId wheel = Add({.shape = CubeOf(0.2f), .position = {0, 0.9, -1.2}});
        auto hinge = Of<HingeJointSettings>(Between(spoiled, wheel, {0, 0.6, -0.8}));
        hinge.angle.motor = SpeedMotor(2, 10);
        Join(world, hinge);
        const BodyId slide = Add({.shape = CubeOf(0.2f), .position = {1.5, 0.4, -0.8}});
        auto slider = Of<SliderJointSettings>(Between(wheel, slide, {1, 0.5, -1}));
        slider.slide = {.limited = true, .limits = {.min = -0.2f, .max = 0.2f}};
        Join(world, slider);
        world.Steps(30);
    }

    WorldState& State() { return WorldOf(world.System()); }
};

// A number of the state, found anew in each world.
struct Place {
    std::string name;
    std::function<void(Scene&, double)> write;
};

class Places {
public:
    // Each of `count` floats (or doubles) from where `first` says.
    template <class First>
    void AddRun(const std::string& name, int count, First first) {
        for (int i = 0; i < count; ++i)
            list.push_back({name + " " + std::to_string(i), [=](Scene& s, double value) {
                                auto* at = first(s);
                                if (at) at[i] = static_cast<std::remove_reference_t<decltype(*at)>>(value);
                            }});
    }
    std::vector<Place> list;
};

std::vector<Place> PlacesOfBody(const std::string& who, BodyId Scene::*which) {
    Places places;
    const auto add = [&](const char* name, int count, auto of) {
        places.AddRun(who + " " + name, count, [=](Scene& s) { return of(s.State().bodies, (s.*which).index); });
    };
    add("state", 16, [](BodyStore& b, uint32_t i) { return b.states[i].VelocityRow(); });
    add("mass", 8, [](BodyStore& b, uint32_t i) { return &b.masses[i].inverseInertia[0]; });
    add("rotation and acceleration", 7, [](BodyStore& b, uint32_t i) { return &b.poses[i].rotation[0]; });
    add("position", 3, [](BodyStore& b, uint32_t i) { return &b.poses[i].position[0]; });
    add("remainder", 3, [](BodyStore& b, uint32_t i) { return b.remainders[i].value.data(); });
    add("unconstrained", 8, [](BodyStore& b, uint32_t i) { return b.unconstrained[i].row; });
    add("dynamics", 15, [](BodyStore& b, uint32_t i) { return &b.dynamics[i].inverseInertia[0]; });
    add("force", 3, [](BodyStore& b, uint32_t i) { return b.dynamics[i].hasForce = true, b.cold[i].force.data(); });
    add("torque", 3, [](BodyStore& b, uint32_t i) { return b.dynamics[i].hasForce = true, b.cold[i].torque.data(); });
    return places.list;
}

// Of the n-th contact of the spoiled body.
Pair* ContactOf(Scene& s, int n, ContactRecord** record = nullptr) {
    Pair* found = nullptr;
    s.State().pairs.active.Visit([&](uint32_t index) {
        Pair& pair = s.State().pairs.pairs[index];
        if (!pair.touching || (pair.bodyA != s.spoiled.index && pair.bodyB != s.spoiled.index) || n-- != 0) return;
        found = &pair;
        if (record) *record = &s.State().pairs.RecordOf(pair);
    });
    return found;
}

std::vector<Place> PlacesOfContacts() {
    Places places;
    for (int n = 0; n < 3; ++n) {
        const std::string name = "contact " + std::to_string(n);
        places.AddRun(name, 48, [n](Scene& s) {
            ContactRecord* record = nullptr;
            ContactOf(s, n, &record);
            return record ? record->normal : nullptr;
        });
        places.AddRun(name + " reference", 7, [n](Scene& s) {
            Pair* pair = ContactOf(s, n);
            return pair ? s.State().pairs.contacts[pair->contact].reference.position.data() : nullptr;
        });
        places.AddRun(name + " cache", 3, [n](Scene& s) {
            Pair* pair = ContactOf(s, n);
            return pair ? pair->cache.axis : nullptr;
        });
    }
    return places.list;
}

std::vector<Place> PlacesOfJoints() {
    Places places;
    for (size_t joint : {0u, 1u, 4u, 5u}) {
        const std::string name = "joint " + std::to_string(joint);
        places.AddRun(name + " record", 40, [=](Scene& s) { return s.State().joints.records[joint].anchorA; });
        places.AddRun(name + " impulses", 6, [=](Scene& s) { return s.State().joints.types[joint]->impulses.data(); });
        places.AddRun(name + " turned", 6, [=](Scene& s) { return s.State().joints.types[joint]->turnedA.data(); });
    }
    return places.list;
}

// What may be read of a world is finite, and nothing flies about.
void ExpectSane(Scene& s, const std::string& what) {
    for (BodyId id : s.bodies) {
        const Pose pose = s.world.Bodies().GetPose(id);
        const Vector3 v = s.world.Bodies().GetLinearVelocity(id), w = s.world.Bodies().GetAngularVelocity(id);
        ASSERT_TRUE(IsFinite(pose.position) && IsFinite(pose.rotation) && IsFinite(v) && IsFinite(w))
            << what << ", body " << id.index;
        ASSERT_LT(pose.position.norm(), 2000) << what << ", body " << id.index;  // 1000 m/s for 100 steps
        ASSERT_TRUE(!s.world.Bodies().IsFrozen(id) || (v.isZero(0) && w.isZero(0))) << what;
    }
    s.world.System().VisitContacts([&](const ContactView& contact) {
        EXPECT_TRUE(IsFinite(contact.normal)) << what;
        for (const ContactView::Point& p : contact.points)
            EXPECT_TRUE(IsFinite(p.position) && std::isfinite(p.separation) && std::isfinite(p.impulse)) << what;
    });
}

// None but the spoiled one may be frozen, and that comes back when it is placed anew.
void Spoil(const Place& place, double value, BodyId mayFreeze) {
    Scene s;
    const std::string what = place.name + " = " + std::to_string(value);
    place.write(s, value);
    for (int i = 0; i < 100; ++i) {
        s.world.Step();
        ExpectSane(s, what + ", step " + std::to_string(i));
        if (::testing::Test::HasFailure()) return;
    }
    for (BodyId id : s.bodies)
        EXPECT_TRUE(!s.world.Bodies().IsFrozen(id) || id == mayFreeze) << what << ", body " << id.index;
    if (mayFreeze == BodyId{} || !s.world.Bodies().IsFrozen(mayFreeze)) return;
    ASSERT_TRUE(s.world.Bodies().SetPose(mayFreeze, {5, 3, 5}, {}));
    EXPECT_FALSE(s.world.Bodies().IsFrozen(mayFreeze));
    EXPECT_EQ(s.world.Bodies().GetLinearVelocity(mayFreeze), Vector3(0, 0, 0));
    s.world.Steps(10);
    ExpectSane(s, what + ", thawed");
}

void SpoilAll(const std::vector<Place>& places, BodyId mayFreeze) {
    for (size_t i = 0; i < places.size(); ++i)
        for (float value : {kNaN, -kInfinity}) {
            // The sanitizers, which take minutes of it, see one of the two in turn.
            if (kIsSanitized && (i % 2 == 0) != std::isnan(value)) continue;
            Spoil(places[i], value, mayFreeze);
            if (::testing::Test::HasFailure()) return;
        }
}

TEST(NonFiniteState, OfADynamicBodyStaysWithIt) { SpoilAll(PlacesOfBody("box", &Scene::spoiled), Scene().spoiled); }
TEST(NonFiniteState, OfAKinematicBodyStaysWithIt) {
    SpoilAll(PlacesOfBody("platform", &Scene::platform), Scene().platform);
}
TEST(NonFiniteState, OfContactsIsForgotten) { SpoilAll(PlacesOfContacts(), {}); }
TEST(NonFiniteState, OfJointsIsForgotten) { SpoilAll(PlacesOfJoints(), {}); }

TEST(NonFiniteState, AFrozenBodyStaysAtRestAmongOthers) {
    Scene s;
    for (int i = 0; i < 2; ++i) ASSERT_TRUE(s.world.Bodies().AddForce(s.spoiled, {3e38f, 0, 0}));
    const Position before = s.world.PositionOf(s.spoiled);
    s.world.Step();
    ASSERT_TRUE(s.world.Bodies().IsFrozen(s.spoiled));
    EXPECT_EQ(s.world.Report().frozenBodies, 1u);
    EXPECT_EQ(s.world.Report().firstFrozen, s.spoiled);
    // Whatever gets into its velocity, by a row or otherwise, goes no further.
    for (int i = 0; i < 100; ++i) {
        s.State().bodies.SetVelocity(s.spoiled.index, Vector3(kNaN, kInfinity, 0), Vector3(0, kNaN, 0));
        s.world.Step();
        ExpectSane(s, "step " + std::to_string(i));
        if (HasFailure()) return;
        EXPECT_EQ(s.world.Report().frozenBodies, 0u);
    }
    EXPECT_EQ(s.world.PositionOf(s.spoiled), before);
}

}  // namespace
}  // namespace fulcrum::testing
