// Joints and contacts for which bodies have other masses than their own, against closed forms.
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>
#include <Fulcrum/UnitTests/Support/AllocationCounter.h>

#include <functional>

namespace fulcrum::testing {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN(), kEndless = std::numeric_limits<float>::infinity();
constexpr float kMassA = 1, kMassB = 3;  // kg
constexpr float kSpeed = 2;              // m/s

class Overriding final : public ContactListener {
public:
    std::function<void(const ContactView&, ContactChange&)> modify = [](const ContactView&, ContactChange&) {};
    void ModifyContact(const ContactView& contact, ContactChange& change) const override { modify(contact, change); }
};

// Of the inverse masses of the first and of the second body.
struct Scales {
    float first, second;
};
constexpr Scales kScales[] = {{1, 1}, {1, 0}, {0, 1}, {0.5f, 2}, {0.25f, 0.25f}, {4, 0.125f}};

// Velocities after two bodies of which the first moved with kSpeed exchanged an impulse along the line of their centers
// and part with `restitution` times that.
struct Ending {
    double first, second;
};
Ending EndingOf(const Scales& scales, double restitution = 0) {
    const double a = double(scales.first / kMassA), b = double(scales.second / kMassB);
    const double impulse = (1 + restitution) * double(kSpeed) / (a + b);
    return {double(kSpeed) - impulse * a, impulse * b};
}

MassOverride OverrideOf(const Scales& scales) { return {scales.first, scales.first, scales.second, scales.second}; }

// ---- contacts

struct Collision {
    TestWorld world{Weightless()};
    Overriding listener;
    BodyId first, second;

    Collision(float restitution, ContinuousCollision continuous = ContinuousCollision::Off, float speed = kSpeed) {
        const Material material{.friction = 0, .restitution = restitution};
        first = world.Add({.shape = SphereOf(0.5f),
                           .position = {-0.625, 0, 0},
                           .linearVelocity = {speed, 0, 0},
                           .mass = kMassA,
                           .material = material,
                           .continuous = continuous});
        second = world.Add({.shape = SphereOf(0.5f), .position = {0.625, 0, 0}, .mass = kMassB, .material = material});
        world.System().SetContactListener(&listener);
    }
    void Override(const Scales& scales) {
        listener.modify = [=, this](const ContactView& contact, ContactChange& change) {
            change.ScaleInverseMass(contact, first, scales.first);
            change.ScaleInverseMass(contact, second, scales.second);
        };
    }
};

TEST(MassOverrideOfContacts, BodiesHitEachOtherAsIfTheyHadTheseMasses) {
    for (const Scales& scales : kScales)
        for (float restitution : {0.0f, 1.0f}) {
            SCOPED_TRACE(::testing::Message() << scales.first << " " << scales.second << " " << restitution);
            Collision c(restitution);
            c.Override(scales);
            c.world.Run(0.5);
            const Ending expected = EndingOf(scales, double(restitution));
            EXPECT_NEAR(c.world.VelocityOf(c.first).x(), expected.first, 2e-3);
            EXPECT_NEAR(c.world.VelocityOf(c.second).x(), expected.second, 2e-3);
        }
}

TEST(MassOverrideOfContacts, WhatCannotBeMovedIsNotTouched) {
    Collision c(0);
    const BodyBits before = BitsOf(c.world, c.second);
    c.Override({1, 0});
    c.world.Run(0.5);
    EXPECT_EQ(BitsOf(c.world, c.second), before);
    EXPECT_NEAR(c.world.VelocityOf(c.first).x(), 0, 1e-3);
}

TEST(MassOverrideOfContacts, NothingHappensWhereNeitherBodyCanMove) {
    Collision c(0);
    c.Override({0, 0});
    c.world.Run(1.5);
    EXPECT_EQ(c.world.VelocityOf(c.first).x(), kSpeed);
    EXPECT_EQ(c.world.VelocityOf(c.second).x(), 0);
    EXPECT_GT(c.world.PositionOf(c.first).x(), 2);
}

// A ball hits the end of a rod: the rod's response there is s / m + s' r^2 / I.
TEST(MassOverrideOfContacts, TheInertiaIsScaledByItself) {
    for (float mass : {1.0f, 0.5f})
        for (float inertia : {1.0f, 0.25f, 0.0f}) {
            SCOPED_TRACE(::testing::Message() << mass << " " << inertia);
            TestWorld world(Weightless());
            const Material smooth{.friction = 0};
            constexpr double kArm = 0.8, kInertia = 3;
            const BodyId ball = world.Add({.shape = SphereOf(0.1f),
                                           .position = {kArm, -0.25, 0},
                                           .linearVelocity = {0, kSpeed, 0},
                                           .mass = kMassA,
                                           .material = smooth});
            const BodyId rod = world.Add({.shape = BoxOf(1, 0.1f, 0.1f),
                                          .mass = kMassB,
                                          .inertia = Vector3(1, 1, kInertia),
                                          .material = smooth});
            Overriding listener;
            listener.modify = [&](const ContactView& contact, ContactChange& change) {
                MassOverride o{.inverseMassScaleA = mass, .inverseInertiaScaleA = inertia};
                change.massOverride = contact.bodyA == rod ? o : o.Swapped();
            };
            world.System().SetContactListener(&listener);
            while (world.VelocityOf(rod).isZero(0)) world.Step(1.0 / 240);
            world.Step(1.0 / 240);
            const double inverseB = double(mass) / double(kMassB), inverseI = double(inertia) / kInertia;
            const double impulse = double(kSpeed) / (1 / double(kMassA) + inverseB + kArm * kArm * inverseI);
            EXPECT_NEAR(world.VelocityOf(ball).y(), double(kSpeed) - impulse / double(kMassA), 0.01);
            EXPECT_NEAR(world.VelocityOf(rod).y(), impulse * inverseB, 0.01);
            EXPECT_NEAR(world.Bodies().GetAngularVelocity(rod).z(), impulse * kArm * inverseI, 0.01);
        }
}

TEST(MassOverrideOfContacts, HoldsWhereContinuousCollisionHits) {
    for (const Scales& scales : kScales) {
        SCOPED_TRACE(::testing::Message() << scales.first << " " << scales.second);
        constexpr float kFast = 300;
        Collision c(1, ContinuousCollision::Linear, kFast);
        ASSERT_TRUE(c.world.Bodies().SetPose(c.first, {-3, 0, 0}, {}));
        c.Override(scales);
        c.world.Steps(3);
        const Ending expected = EndingOf(scales, 1);
        EXPECT_NEAR(c.world.VelocityOf(c.first).x(), expected.first * double(kFast / kSpeed), 0.01);
        EXPECT_NEAR(c.world.VelocityOf(c.second).x(), expected.second * double(kFast / kSpeed), 0.01);
    }
}

TEST(MassOverrideOfContacts, LastsForAStep) {
    TestWorld world(NoSleep());
    Overriding listener;
    const BodyId floor = world.AddFloor();
    const BodyId box = world.Add({.shape = CubeOf(0.5f), .position = {0, 0.5, 0}, .mass = 8});
    // So heavy that the floor does nothing to it.
    listener.modify = [](const ContactView& contact, ContactChange& change) {
        change.ScaleInverseMass(contact, contact.bodyA, 0);
    };
    world.System().SetContactListener(&listener);
    world.Steps(2);
    EXPECT_NEAR(world.VelocityOf(box).y(), -2 * kGravity * kStep, 1e-5);
    EXPECT_EQ(world.ForceBetween(box, floor), 0);
    listener.modify = [](const ContactView&, ContactChange&) {};
    world.Run(1);
    EXPECT_NEAR(world.VelocityOf(box).y(), 0, 1e-3);
    EXPECT_NEAR(world.ForceBetween(box, floor), 8 * kGravity, 0.01 * 8 * kGravity);
}

// Also of a contact whose neighbors in the same lanes have one.
TEST(MassOverrideOfContacts, WithoutOneEveryBitStays) {
    const auto run = [](const std::function<void(const ContactView&, ContactChange&)>& modify) {
        TestWorld world;
        Overriding listener;
        listener.modify = modify;
        world.AddFloor();
        std::vector<BodyId> boxes;
        for (int i = 0; i < 20; ++i)
            boxes.push_back(world.Add({.shape = CubeOf(0.5f),
                                       .position = {2.0 * i, 1, 0},
                                       .linearVelocity = {1, 0, 0.5f},
                                       .angularVelocity = {1, 2, 3}}));
        world.System().SetContactListener(&listener);
        world.Steps(40);
        std::vector<BodyBits> bits;
        for (BodyId box : boxes) bits.push_back(BitsOf(world, box));
        return bits;
    };
    const std::vector<BodyBits> plain = run([](const ContactView&, ContactChange&) {});
    EXPECT_EQ(run([](const ContactView&, ContactChange& change) { change.massOverride = {1, 1, 1, 1}; }), plain);
    for (const MassOverride& wrong : {MassOverride{kNaN, 1, 1, 1}, MassOverride{1, -1, 1, 1},
                                      MassOverride{1, 1, kEndless, 1}, MassOverride{0, 0, 0, 1.1e6f}})
        EXPECT_EQ(run([&](const ContactView&, ContactChange& change) { change.massOverride = wrong; }), plain);
    const std::vector<BodyBits> some = run([](const ContactView& contact, ContactChange& change) {
        if (contact.bodyA.index % 2 == 0) change.massOverride.inverseMassScaleA = 0.5f;
    });
    int changed = 0;
    for (size_t i = 0; i < plain.size(); ++i) {
        // The floor has index 0.
        const bool same = some[i] == plain[i];
        if (i % 2 == 0) {
            EXPECT_TRUE(same) << i;
        } else {
            changed += !same;
        }
    }
    EXPECT_EQ(changed, 10);
}

TEST(MassOverrideOfContacts, ASettledStepAllocatesNothing) {
    TestWorld world(NoSleep());
    Overriding listener;
    listener.modify = [](const ContactView& contact, ContactChange& change) {
        change.ScaleInverseMass(contact, contact.bodyA, 0.5f);
    };
    world.System().SetContactListener(&listener);
    world.AddFloor();
    for (int i = 0; i < 30; ++i) world.Add({.shape = CubeOf(0.5f), .position = {0.01 * i, 0.5 + i % 5, 2.0 * (i / 5)}});
    world.Run(1);
    const uint64_t before = AllocationCount();
    world.Steps(10);
    EXPECT_EQ(AllocationCount(), before);
}

// ---- joints

struct Two {
    TestWorld world;
    BodyId first, second;
    explicit Two(const SystemSettings& settings, double gap = 0)
        : world(settings),
          first(world.Add({.shape = CubeOf(0.1f), .position = {-0.5 - gap / 2, 0, 0}, .mass = kMassA})),
          second(world.Add({.shape = CubeOf(0.1f), .position = {0.5 + gap / 2, 0, 0}, .mass = kMassB})) {}

    JointSettings Settings(const Scales& scales, double gap = 0) const {
        JointSettings settings = Between(first, second, {-gap / 2, 0, 0});
        if (gap > 0) settings.anchorB = AnchorAt({gap / 2, 0, 0});
        settings.massOverride = OverrideOf(scales);
        return settings;
    }
};

SystemSettings WeightlessWith(PositionCorrection correction) {
    SystemSettings settings = Weightless();
    settings.solver.positionCorrection = correction;
    return settings;
}
constexpr PositionCorrection kCorrections[] = {PositionCorrection::SoftRelax, PositionCorrection::Baumgarte};

template <class Settings>
void ExpectExchange(const Settings& own) {
    for (PositionCorrection correction : kCorrections)
        for (const Scales& scales : kScales) {
            SCOPED_TRACE(::testing::Message() << scales.first << " " << scales.second);
            Two pair(WeightlessWith(correction));
            Settings settings = own;
            static_cast<JointSettings&>(settings) = pair.Settings(scales);
            Join(pair.world, settings);
            ASSERT_TRUE(pair.world.Bodies().SetVelocity(pair.first, {kSpeed, 0, 0}, {0, 0, 0}));
            pair.world.Steps(30);
            const Ending expected = EndingOf(scales);
            EXPECT_NEAR(pair.world.VelocityOf(pair.first).x(), expected.first, 1e-3);
            EXPECT_NEAR(pair.world.VelocityOf(pair.second).x(), expected.second, 1e-3);
        }
}

TEST(MassOverrideOfJoints, BodiesPullEachOtherAsIfTheyHadTheseMasses) {
    ExpectExchange(PointJointSettings{});
    ExpectExchange(FixedJointSettings{});
    DistanceJointSettings rod;
    rod.minDistance = rod.maxDistance = 0.0f;
    ExpectExchange(rod);
    SixDofJointSettings locked;
    for (AxisControl& axis : locked.axes) axis = kLockedAxis;
    ExpectExchange(locked);
    ExpectExchange(HingeJointSettings{});
}

TEST(MassOverrideOfJoints, AngularVelocityIsSharedByTheScaledInertias) {
    for (const Scales& scales : kScales) {
        SCOPED_TRACE(::testing::Message() << scales.first << " " << scales.second);
        Two pair(Weightless());
        FixedJointSettings settings{pair.Settings(scales)};
        // Nothing but the rotation about the line of the centers matters.
        Join(pair.world, settings);
        ASSERT_TRUE(pair.world.Bodies().SetVelocity(pair.first, {0, 0, 0}, {kSpeed, 0, 0}));
        pair.world.Step();
        const Ending expected = EndingOf(scales);  // inertias are as the masses
        EXPECT_NEAR(pair.world.Bodies().GetAngularVelocity(pair.first).x(), expected.first, 1e-3);
        EXPECT_NEAR(pair.world.Bodies().GetAngularVelocity(pair.second).x(), expected.second, 1e-3);
    }
}

// Gaps are closed by both bodies in the ratio of their inverse masses: small ones by pushes or position passes, large
// ones by a pull.
TEST(MassOverrideOfJoints, GapsAreClosedInTheRatioOfTheInverseMasses) {
    for (PositionCorrection correction : kCorrections)
        for (double gap : {1.0 / 128, 3.0})
            for (const Scales& scales : kScales)
                for (bool isFixed : {false, true}) {
                    SCOPED_TRACE(::testing::Message() << gap << " " << scales.first << " " << scales.second);
                    Two pair(WeightlessWith(correction), gap);
                    if (isFixed) Join(pair.world, FixedJointSettings{pair.Settings(scales, gap)});
                    else Join(pair.world, PointJointSettings{pair.Settings(scales, gap)});
                    const double from = pair.world.PositionOf(pair.first).x(),
                                 to = pair.world.PositionOf(pair.second).x();
                    pair.world.Run(4);
                    const double a = double(scales.first / kMassA), b = double(scales.second / kMassB);
                    EXPECT_NEAR(pair.world.PositionOf(pair.first).x() - from, gap * a / (a + b), 0.01 * gap);
                    EXPECT_NEAR(pair.world.PositionOf(pair.second).x() - to, -gap * b / (a + b), 0.01 * gap);
                    if (scales.second == 0) {
                        EXPECT_EQ(pair.world.PositionOf(pair.second).x(), to);
                    }
                }
}

TEST(MassOverrideOfJoints, MayBeChangedAndRead) {
    Two pair(Weightless());
    JointInterface& joints = JointsOf(pair.world);
    const JointId joint = Join(pair.world, PointJointSettings{pair.Settings({0.5f, 2})});
    EXPECT_EQ(joints.GetMassOverride(joint), OverrideOf({0.5f, 2}));
    ASSERT_TRUE(joints.SetMassOverride(joint, OverrideOf({1, 0})));
    EXPECT_EQ(joints.GetMassOverride(joint), OverrideOf({1, 0}));
    ASSERT_TRUE(pair.world.Bodies().SetVelocity(pair.first, {kSpeed, 0, 0}, {0, 0, 0}));
    pair.world.Step();
    EXPECT_NEAR(pair.world.VelocityOf(pair.first).x(), 0, 1e-3);
    EXPECT_EQ(pair.world.VelocityOf(pair.second).x(), 0);
    ASSERT_TRUE(joints.SetMassOverride(joint, {}));
    ASSERT_TRUE(pair.world.Bodies().SetVelocity(pair.first, {kSpeed, 0, 0}, {0, 0, 0}));
    pair.world.Step();
    EXPECT_NEAR(pair.world.VelocityOf(pair.first).x(), EndingOf({1, 1}).first, 1e-3);
}

TEST(MassOverrideOfJoints, IsRefusedWhereItIsWrong) {
    Two pair(Weightless());
    JointInterface& joints = JointsOf(pair.world);
    const JointId joint = Join(pair.world, PointJointSettings{pair.Settings({0.5f, 2})});
    const auto expect = [&](const MassOverride& wrong, ErrorCode code, const char* field) {
        PointJointSettings settings{pair.Settings({1, 1})};
        settings.massOverride = wrong;
        for (const Error& error :
             {joints.SetMassOverride(joint, wrong).GetError(), joints.Create(settings).GetError()}) {
            EXPECT_EQ(error.code, code);
            EXPECT_TRUE(error.message.starts_with(field)) << error.message;
        }
        EXPECT_EQ(joints.GetMassOverride(joint), OverrideOf({0.5f, 2}));
    };
    expect({kNaN, 1, 1, 1}, ErrorCode::NonFinite, "massOverride.inverseMassScaleA ");
    expect({1, -1, 1, 1}, ErrorCode::OutOfRange, "massOverride.inverseInertiaScaleA ");
    expect({1, 1, 1.1e6f, 1}, ErrorCode::OutOfRange, "massOverride.inverseMassScaleB ");
    expect({1, 1, 1, kEndless}, ErrorCode::NonFinite, "massOverride.inverseInertiaScaleB ");
    EXPECT_EQ(joints.SetMassOverride({}, {}).GetError().code, ErrorCode::UnknownId);
    EXPECT_EQ(joints.GetMassOverride({}), MassOverride{});
}

// Of joints whose neighbors in the same lanes have one.
TEST(MassOverrideOfJoints, OthersKeepEveryBit) {
    const auto run = [](bool some) {
        TestWorld world;
        const BodyId hook = AddHook(world);
        std::vector<BodyId> ends;
        for (int i = 0; i < 16; ++i) {
            const BodyId a = world.Add({.shape = BoxOf(0.2f, 0.1f, 0.1f), .position = {0.2, 0, 1.0 * i}}),
                         b = world.Add({.shape = BoxOf(0.2f, 0.1f, 0.1f), .position = {0.6, 0, 1.0 * i}});
            Join(world, HingeJointSettings{Between(hook, a, {0, 0, 1.0 * i}, {0, 0, 1})});
            HingeJointSettings settings{Between(a, b, {0.4, 0, 1.0 * i}, {0, 0, 1})};
            if (some && i % 2 == 1) settings.massOverride = OverrideOf({0.5f, 1});
            Join(world, settings);
            ends.push_back(b);
        }
        world.Steps(40);
        std::vector<BodyBits> bits;
        for (BodyId end : ends) bits.push_back(BitsOf(world, end));
        return bits;
    };
    const std::vector<BodyBits> plain = run(false), some = run(true);
    for (size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(some[i] == plain[i], i % 2 == 0) << i;
}

// A chain under a load that is solved as a tree, unless one of its joints has other masses than its bodies.
TEST(MassOverrideOfJoints, TreesHaveNone) {
    const auto gapOf = [](const MassOverride& massOverride) {
        TestWorld world(NoSleep());
        BodyId above = AddHook(world);
        JointId joint;
        double largest = 0;
        for (int i = 0; i < 10; ++i) {
            const bool last = i == 9;
            const BodyId link = world.Add({.shape = last ? SphereOf(0.3f) : BoxOf(0.5f, 0.05f, 0.05f),
                                           .position = {i + (last ? 0.3 : 0.5), 0, 0},
                                           .mass = last ? 500.0f : 1.0f});
            PointJointSettings settings{Between(above, link, {1.0 * i, 0, 0})};
            if (i == 4) settings.massOverride = massOverride;
            joint = Join(world, settings);
            above = link;
        }
        for (int step = 0; step < 60; ++step) {
            world.Step();
            largest = std::max(largest, double(world.Report().largestJointError));
        }
        EXPECT_TRUE(world.AllFinite());
        return largest;
    };
    const double exact = gapOf({});
    EXPECT_LT(exact, 1e-3);
    EXPECT_EQ(gapOf({1, 1, 1, 1}), exact);
    EXPECT_GT(gapOf({0.5f, 0.5f, 1, 1}), 10 * exact);
}

}  // namespace
}  // namespace fulcrum::testing
