// A thin floor pushes two children of a compound out on opposite sides, with forces far above its weight. When one of
// them turns to the other side, its impulses are dropped; those of the other one were warm started alone, and threw the
// compound out at 22 to 29 m/s.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <algorithm>

namespace fulcrum::testing {
namespace {

struct Squeezed {
    float upper, lower;    // half sizes of the children, m
    float apart, height;   // m, of their centers from that of the compound
    float aboutX, aboutZ;  // rotation, rad
    float floorHeight;     // m
    float speed;           // m/s, upwards
};

constexpr Squeezed kCases[] = {{0.35f, 0.25f, 0.2f, 0.2f, 0, -0.3f, 0.2f, -1},
                               {0.3f, 0.35f, 0.3f, 0.25f, 0.2f, -0.1f, 0.1f, -2},
                               {0.25f, 0.35f, 0.3f, 0.25f, 0.1f, -0.3f, 0.2f, -2},
                               {0.25f, 0.35f, 0.3f, 0.25f, 0.2f, -0.3f, 0.1f, -1},
                               {0.15f, 0.35f, 0.2f, 0.2f, 0, -0.2f, 0.2f, 0}};

// The largest speed in 40 steps after a static slab of 1 m is moved into the compound.
float LargestSpeed(const Squeezed& at) {
    TestWorld world;
    const BodyId slab = world.Add({.shape = BoxOf(50, 0.5f, 50),
                                   .motion = MotionType::Static,
                                   .position = {0, -10, 0},
                                   .material = {.friction = 0}});
    const BodyId compound =
        world.Add({.shape = CompoundOf({{.shape = CubeOf(at.upper), .position = {-at.apart, at.height, 0}},
                                        {.shape = BoxOf(at.lower, 0.2f, 0.4f), .position = {at.apart, -at.height, 0}}}),
                   .rotation = RotationFromVector(Vector3(at.aboutX, 0, at.aboutZ)),
                   .material = {.friction = 0}});
    world.Steps(2);
    EXPECT_TRUE(world.Bodies().SetPose(slab, {0, double{at.floorHeight}, 0}, {}));
    EXPECT_TRUE(world.Bodies().SetVelocity(compound, Vector3(0, at.speed, 0), Vector3::Zero()));
    float largest = 0;
    for (int i = 0; i < 40; ++i) {
        world.Step();
        largest = std::max(largest, Length(world.VelocityOf(compound)));
    }
    return largest;
}

TEST(TurnedNormal, OfAChildDoesNotThrowACompoundOut) {
    // Bodies are pushed out at contactPushSpeed at most, and fall for 40 steps: 7 m/s.
    const float most = SystemSettings{}.contactPushSpeed + static_cast<float>(kGravity * 40 * kStep);
    for (const Squeezed& at : kCases) EXPECT_LT(LargestSpeed(at), most);
}

}  // namespace
}  // namespace fulcrum::testing
