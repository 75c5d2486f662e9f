#include <Fulcrum/Constraints/Joints/JointDrawing.h>
#include <Fulcrum/Samples/Runner/JointRecorder.h>
#include <Fulcrum/UnitTests/Physics/Joints/JointTools.h>

#include <set>
#include <string>
#include <type_traits>

namespace fulcrum::testing {
namespace {

class JointRecording : public ::testing::Test {
protected:
    JointRecording() : world_(Weightless()) {
        hook_ = Body({0, 5, 0}, MotionType::Static);
        box_ = Body({1, 5, 0}, MotionType::Dynamic);
    }

    BodyId Body(const Position& position, MotionType motion) {
        bodies_.push_back(world_.Add({.shape = CubeOf(0.1f),
                                      .motion = motion,
                                      .position = position,
                                      .rotation = RotationAbout({0, 0, 1}, 0.3)}));
        return bodies_.back();
    }
    RecordedFrameJoints Collect() {
        if (!recorder_) {
            recorder_.emplace(world_.System(), Position(0, 1, 0), [this](BodyId id) -> std::optional<uint32_t> {
                for (uint32_t i = 0; i < bodies_.size(); ++i)
                    if (bodies_[i] == id) return i;
                return std::nullopt;
            });
        }
        return recorder_->Collect(joints_);
    }

    TestWorld world_;
    std::vector<BodyId> bodies_;  // that are recorded
    BodyId hook_, box_;
    std::vector<RecordedJoint> joints_;
    std::optional<JointRecorder> recorder_;
};

TEST_F(JointRecording, EachKindHasANameOfItsOwn) {
    size_t count = 0;
    const auto add = [&]<class Settings>(std::type_identity<Settings>) {
        Settings settings = Of<Settings>(Between(hook_, box_, {0.5, 5, 0}));
        if constexpr (requires { settings.make; })
            settings.make = [] {
                class Nothing : public JointType {};
                return std::make_unique<Nothing>();
            };
        Join(world_, settings);
        ++count;
    };
#define FULCRUM_ADD(kind) add(std::type_identity<kind##JointSettings>{});
    FULCRUM_FOR_EACH_JOINT_KIND(FULCRUM_ADD)
#undef FULCRUM_ADD
    Collect();
    ASSERT_EQ(joints_.size(), count);
    std::set<std::string> names;
    for (const RecordedJoint& joint : joints_) names.insert(joint.kind);
    EXPECT_EQ(names.size(), count);
    EXPECT_TRUE(names.contains("hinge"));
}

TEST_F(JointRecording, AUsersOwnJointIsDrawnAsItSays) {
    class Bayonet final : public JointType {
        const char* Kind() const override { return "bayonet"; }
        JointDrawing Drawing() const override { return {.trackA = 2, .circleB = 0.3f}; }
    };
    CustomJointSettings settings = Of<CustomJointSettings>(Between(hook_, box_, {0.5, 5, 0}));
    settings.make = [] { return std::make_unique<Bayonet>(); };
    Join(world_, settings);
    Collect();
    EXPECT_EQ(joints_[0].kind, "bayonet");
    EXPECT_EQ(joints_[0].trackA, 2);
    EXPECT_EQ(joints_[0].circleB, 0.3f);
    EXPECT_FALSE(joints_[0].circleA);
}

// Two to one over 0.9 m: 0.6 m and 0.3 m.
TEST_F(JointRecording, PitchCirclesOfGearsMeet) {
    GearJointSettings gear = Of<GearJointSettings>(Between(hook_, box_, {0, 5, 0}));
    gear.anchorB = AnchorAt({0.9, 5, 0});
    gear.ratio = 0.5f;
    Join(world_, gear);
    Collect();
    EXPECT_NEAR(joints_[0].circleA.value(), 0.6f, 1e-5f);
    EXPECT_NEAR(joints_[0].circleB.value(), 0.3f, 1e-5f);
}

TEST_F(JointRecording, FramesAreSeenFromTheBodies) {
    const JointId id = Join(world_, HingeJointSettings{Between(hook_, box_, {0.5, 5, 0}, {0, 1, 0})});
    Collect();
    ASSERT_TRUE(world_.Bodies().SetPose(box_, {3, 2, 1}, RotationAbout({0, 1, 0}, 0.7)));
    for (const bool isA : {true, false}) {
        const RelativePose& frame = isA ? joints_[0].frameA : joints_[0].frameB;
        const Pose expected = isA ? JointsOf(world_).GetFrameA(id) : JointsOf(world_).GetFrameB(id);
        const Pose found = world_.Bodies().GetPose(isA ? hook_ : box_) * frame;
        // Rounding of a few float operations at 1 to 5 m.
        EXPECT_LT((found.position - expected.position).norm(), 1e-5);
        EXPECT_LT(Length(RotationVectorOf<float>(found.rotation.Conjugate() * expected.rotation)), 1e-5f);
    }
}

TEST_F(JointRecording, HasLimitsAndLocks) {
    HingeJointSettings hinge{Between(hook_, box_, {0.5, 5, 0})};
    hinge.angle = Limited(-1, 2);
    const JointId id = Join(world_, hinge);
    ConeJointSettings cone{Between(hook_, box_, {0.5, 5, 0})};
    cone.halfAngle = 0.6f;
    Join(world_, cone);
    RecordedFrameJoints now = Collect();
    EXPECT_EQ(joints_[0].linearLock, RecordedLinearLock::Point);
    EXPECT_EQ(joints_[0].angularLock, RecordedAngularLock::Axis);
    EXPECT_EQ(joints_[0].axis, 0);
    EXPECT_EQ(now.states[0].limits[3], (RecordedRange{-1, 2}));
    EXPECT_EQ(now.states[0].limits[0], RecordedRange{});
    for (const size_t axis : {4, 5}) EXPECT_EQ(now.states[1].limits[axis], (RecordedRange{-0.6f, 0.6f}));
    ASSERT_TRUE(JointsOf(world_).SetLimits(id, JointAxis::AngularX, std::nullopt));
    now = Collect();
    EXPECT_EQ(now.states[0].limits[3], RecordedRange{});
}

TEST_F(JointRecording, PathAndPulleyHaveTheirPoints) {
    PathJointSettings path{Between(hook_, box_, {0.5, 5, 0})};
    path.path = Path::Straight(4.0f);
    Join(world_, path);
    PulleyJointSettings pulley = Of<PulleyJointSettings>(Between(hook_, box_, {0.5, 5, 0}));
    pulley.fixedPointA = {0, 7, 0};
    pulley.fixedPointB = {1, 7, 0};
    pulley.ratio = 3;
    Join(world_, pulley);
    Collect();
    ASSERT_GT(joints_[0].points.size(), 2u);
    EXPECT_FLOAT_EQ(joints_[0].points.front().x(), -2);
    EXPECT_FLOAT_EQ(joints_[0].points.back().x(), 2);
    EXPECT_FALSE(joints_[0].isClosed);
    ASSERT_EQ(joints_[1].points.size(), 2u);
    EXPECT_EQ(joints_[1].points[1], Vector3(1, 6, 0)) << "relative to the recording's origin";
    EXPECT_EQ(joints_[1].ratio, 3);
    EXPECT_TRUE(joints_[1].isHardLength);
}

TEST_F(JointRecording, LargestErrorsAreThoseThatAreReadBack) {
    PointJointSettings settings{Between(hook_, box_, {0.5, 5, 0})};
    Join(world_, settings);
    settings.space = JointSpace::Body;
    settings.anchorA = AnchorAt({0, 0, 0});
    settings.anchorB = AnchorAt({0, 0.25, 0});
    const JointId apart = Join(world_, settings);
    const RecordedFrameJoints now = Collect();
    EXPECT_EQ(now.errors.distanceJoint, 1u);
    EXPECT_EQ(now.errors.distance, JointsOf(world_).GetError(apart).distance);
    EXPECT_GT(now.errors.distance, 0.5f);
    EXPECT_EQ(now.errors.angle, 0);
}

TEST_F(JointRecording, RodThatIsTooShortIsAnErrorAndASpringIsNot) {
    DistanceJointSettings rod{Between(hook_, box_, {0, 5, 0})};
    rod.anchorB = AnchorAt({1, 5, 0});
    rod.minDistance = rod.maxDistance = 1.5f;
    const JointId id = Join(world_, rod);
    // Half a meter, within rounding of the places.
    EXPECT_NEAR(Collect().errors.distance, 0.5f, 1e-5f);
    ASSERT_TRUE(JointsOf(world_).Remove(id));
    rod.spring.frequency = 1;
    Join(world_, rod);
    EXPECT_EQ(Collect().errors.distance, 0);
}

TEST_F(JointRecording, WhatIsSwitchedOffOrRemovedIsOffAndNewOnesComeLast) {
    const JointId first = Join(world_, PointJointSettings{Between(hook_, box_, {0.5, 5, 0})});
    const JointId second = Join(world_, PointJointSettings{Between(hook_, box_, {0.5, 5, 0})});
    Collect();
    ASSERT_TRUE(JointsOf(world_).SetEnabled(first, false));
    ASSERT_TRUE(JointsOf(world_).Remove(second));
    Join(world_, HingeJointSettings{Between(hook_, box_, {0.5, 5, 0})});  // takes the removed one's index
    const RecordedFrameJoints now = Collect();
    ASSERT_EQ(now.states.size(), 3u);
    EXPECT_FALSE(now.states[0].enabled);
    EXPECT_FALSE(now.states[1].enabled);
    EXPECT_TRUE(now.states[2].enabled);
    EXPECT_EQ(joints_[1].kind, "point");
    EXPECT_EQ(joints_[2].kind, "hinge");
}

TEST_F(JointRecording, JointOfABodyThatIsNotRecordedIsLeftOut) {
    const BodyId stranger = world_.Add({.shape = CubeOf(0.1f), .position = {2, 5, 0}});
    Join(world_, PointJointSettings{Between(hook_, stranger, {1.5, 5, 0})});
    EXPECT_TRUE(Collect().states.empty());
    EXPECT_TRUE(joints_.empty());
}

}  // namespace
}  // namespace fulcrum::testing
