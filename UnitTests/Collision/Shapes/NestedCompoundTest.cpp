// Compounds of compounds: their pieces, places and masses.
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <Fulcrum/Collision/Shapes/MutableCompound.h>
#include <Fulcrum/Collision/Shapes/Scaled.h>

namespace fulcrum::testing {
namespace {

// A dumbbell whose ball at +x is three times as dense: the center is at x = 0.5.
ShapePtr Dumbbell() {
    return CompoundOf({{.shape = SphereOf(0.25f), .position = {-1, 0, 0}, .density = 1},
                       {.shape = SphereOf(0.25f), .position = {1, 0, 0}, .density = 3}});
}

void ExpectSameMass(const MassProperties& a, const MassProperties& b) {
    EXPECT_NEAR(a.volume, b.volume, 1e-6 * b.volume);
    EXPECT_LT(Length(Vector3(a.centerOfMass - b.centerOfMass)), 1e-6f);
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(a.principalInertia[k], b.principalInertia[k], 1e-5 * b.principalInertia.maxCoeff()) << k;
}

TEST(NestedCompound, IsTheCompoundOfAllItsPieces) {
    const Quaternion turned = RotationAbout({0, 0, 1}, kPi / 2);
    const ShapePtr nested = CompoundOf({{.shape = CubeOf(0.5f)},
                                        {.shape = Dumbbell(), .position = {4, 0, 0}, .rotation = turned, .density = 2},
                                        {.shape = SphereOf(1), .position = {0, 0, 5}}});
    // Turned by 90 degrees about z the balls lie at (4, -1, 0) and (4, 1, 0). Their mean density is 2, so 1 and 3.
    const ShapePtr flat = CompoundOf({{.shape = CubeOf(0.5f)},
                                      {.shape = SphereOf(0.25f), .position = {4, -1, 0}, .density = 1},
                                      {.shape = SphereOf(0.25f), .position = {4, 1, 0}, .density = 3},
                                      {.shape = SphereOf(1), .position = {0, 0, 5}}});
    const auto& compound = static_cast<const CompoundShape&>(*nested);
    const auto& expected = static_cast<const CompoundShape&>(*flat);
    ASSERT_EQ(compound.Children().size(), 4u);
    ExpectSameMass(nested->Mass(), flat->Mass());
    for (uint32_t i = 0; i < 4; ++i) {
        const Vector3 apart = compound.ChildAt(i).pose.position - expected.ChildAt(i).pose.position;
        EXPECT_LT(Length(apart), 2e-6f) << i;
        EXPECT_NEAR(compound.ChildAt(i).density, expected.ChildAt(i).density, 1e-5) << i;
    }
    EXPECT_NEAR(nested->OuterRadius(), flat->OuterRadius(), 1e-5);
}

TEST(NestedCompound, KeepsTheBallastOfItsCompounds) {
    const ShapePtr ballasted = OffsetCenterOfMass(Dumbbell(), {0, -0.3f, 0}).Value();
    const ShapePtr one = CompoundOf({{.shape = ballasted, .position = {0, 10, 0}}});
    EXPECT_LT(Length(Vector3(one->Mass().centerOfMass - Vector3(0.5f, 9.7f, 0))), 1e-5f);
    EXPECT_NEAR(one->Mass().principalInertia.maxCoeff(), ballasted->Mass().principalInertia.maxCoeff(), 1e-4);
}

TEST(NestedCompound, TakesAMutableOneAsItIs) {
    const CompoundShape::ChildSettings children[2] = {{.shape = CubeOf(0.5f)},
                                                      {.shape = CubeOf(0.5f), .position = {3, 0, 0}}};
    const auto edited = MutableCompound::Create(children);
    ASSERT_TRUE(edited);
    const ShapePtr nested = CompoundOf({{.shape = edited.Value(), .position = {0, 1, 0}}});
    EXPECT_LT(Length(Vector3(nested->Mass().centerOfMass - Vector3(1.5f, 1, 0))), 1e-5f);
    EXPECT_EQ(static_cast<const CompoundShape&>(*nested).Children().size(), 2u);
}

TEST(NestedCompound, RestsOnTheFloorOnItsPieces) {
    TestWorld world;
    world.AddFloor();
    const ShapePtr legs = CompoundOf({{.shape = BoxOf(0.1f, 0.5f, 0.1f), .position = {-1, 0, 0}},
                                      {.shape = BoxOf(0.1f, 0.5f, 0.1f), .position = {1, 0, 0}}});
    const ShapePtr table = CompoundOf({{.shape = BoxOf(1.2f, 0.1f, 1.2f), .position = {0, 1.1f, 0}},
                                       {.shape = legs, .position = {0, 0.5f, -1}},
                                       {.shape = legs, .position = {0, 0.5f, 1}}});
    const BodyId id = world.Add({.shape = table, .position = {0, 0.01, 0}});
    world.Run(2);
    EXPECT_FALSE(world.Bodies().IsAwake(id));
    EXPECT_NEAR(world.PositionOf(id).y(), 0, 0.005);
}

TEST(NestedCompound, RefusesSurfaces) {
    const CompoundShape::ChildSettings none{.shape = nullptr};
    EXPECT_EQ(Compound::Create({&none, 1}).GetError().code, ErrorCode::Unsupported);
    const CompoundShape::ChildSettings inMutable{.shape = Dumbbell()};
    EXPECT_EQ(MutableCompound::Create({&inMutable, 1}).GetError().code, ErrorCode::Unsupported);
}

}  // namespace
}  // namespace fulcrum::testing
