#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <Fulcrum/Math/Trigonometry.h>

#include <algorithm>
#include <array>

namespace fulcrum::CompoundCityScene {
namespace {

// The city: districts of streets, a compound each; the one in the middle is a square with the tower.
constexpr int kDistricts = 5;   // along each side
constexpr int kBuildings = 12;  // of a district, along each side
constexpr double kStreet = 4;   // m, from building to building
constexpr double kDistrict = kBuildings * kStreet;

// The tower: stories of 16 cubes of a meter around a shaft, under a roof of 25 slabs. It loses all but its lowest
// stories, from the roof down; each lost piece is replaced by a body that was kept under the ground.
constexpr int kStories = 8, kStoriesLeft = 2;
constexpr int kLost = 25 + 16 * (kStories - kStoriesLeft);
constexpr int kFirstStep = 120, kStepsBetween = 3;
constexpr double kTop = kStories + 0.2;  // m
constexpr size_t kOnTheRoof = 9;
constexpr double kDepot = -30;  // m

ShapePtr Prism(SceneWorld& world, int sides, float height, float roof) {
    std::vector<Vector3> points;
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * kPi * i / sides;
        const float x = static_cast<float>(1.3 * Cos(angle)), z = static_cast<float>(1.3 * Sin(angle));
        points.insert(points.end(), {Vector3(x, 0, z), Vector3(x, height, z)});
    }
    if (roof > 0) points.push_back(Vector3(0, height + roof, 0));
    return world.HullOf(points);
}

void AddDistricts(SceneWorld& world) {
    const std::array<ShapePtr, 8> kinds{world.BoxOf(1.2f, 1.5f, 1.2f), world.BoxOf(1.3f, 3, 0.9f),
                                        world.BoxOf(0.9f, 5, 1.1f),    world.BoxOf(1.4f, 1, 1.4f),
                                        Prism(world, 6, 6, 0),         Prism(world, 8, 9, 1),
                                        Prism(world, 4, 2.5f, 1.5f),   Prism(world, 3, 4, 2)};
    for (int district = 0; district < kDistricts * kDistricts; ++district) {
        if (district == kDistricts * kDistricts / 2) continue;
        std::vector<Compound::ChildSettings> buildings;
        for (int i = 0; i < kBuildings * kBuildings; ++i) {
            const ShapePtr& shape = kinds[static_cast<size_t>(world.random.Between(0, 7.999))];
            if (!shape) return;
            // All stand on the ground; hulls have their origin there, boxes in their middle.
            const float foot = shape->LocalBounds().lower.y() + shape->Mass().centerOfMass.y();
            buildings.push_back({.shape = shape,
                                 .position = Vector3(static_cast<float>((i % kBuildings + 0.5) * kStreet), -foot,
                                                     static_cast<float>((i / kBuildings + 0.5) * kStreet)),
                                 .rotation = RotationAbout(Vector3(0, 1, 0), world.random.Between(0, kPi / 2))});
        }
        const double x = (district % kDistricts - 0.5 * kDistricts) * kDistrict,
                     z = (district / kDistricts - 0.5 * kDistricts) * kDistrict;
        world.Add({.shape = world.CompoundOf(buildings), .motion = MotionType::Static, .position = {x, 0, z}});
    }
}

// In the order in which they are lost.
std::vector<CompoundShape::ChildSettings> PiecesOfTheTower(SceneWorld& world) {
    const ShapePtr cube = world.BoxOf(0.5f, 0.5f, 0.5f), slab = world.BoxOf(0.5f, 0.1f, 0.5f);
    std::vector<CompoundShape::ChildSettings> pieces;
    const auto add = [&](const ShapePtr& shape, int i, float y) {
        pieces.push_back(
            {.shape = shape, .position = Vector3(static_cast<float>(i % 5 - 2), y, static_cast<float>(i / 5 - 2))});
    };
    for (int i = 0; i < 25; ++i) add(slab, i, kStories + 0.1f);
    for (int story = kStories - 1; story >= 0; --story) {
        for (int i = 0; i < 25; ++i) {
            const bool isShaft = std::abs(i % 5 - 2) < 2 && std::abs(i / 5 - 2) < 2;
            if (!isShaft) add(cube, i, static_cast<float>(story) + 0.5f);
        }
    }
    return pieces;
}

// Watched are the tower, the bodies on its roof, and the bodies that replace its pieces.
void AddTower(SceneWorld& world) {
    const std::vector<CompoundShape::ChildSettings> pieces = PiecesOfTheTower(world);
    world.watched.push_back(world.Add({.shape = world.MutableCompoundOf(pieces), .motion = MotionType::Static}));
    const ShapePtr barrel = world.CapsuleOf(0.2f, 0.3f), box = world.BoxOf(0.4f, 0.4f, 0.4f);
    for (int i = 0; i < static_cast<int>(kOnTheRoof); ++i) {
        const ShapePtr& shape = i % 2 ? barrel : box;
        world.watched.push_back(
            world.Add({.shape = shape, .position = {1.2 * (i % 3) - 1.2, kTop + 0.5, 1.2 * (i / 3) - 1.2}}));
    }
    // A little smaller than the gap that they leave.
    const ShapePtr cube = world.BoxOf(0.48f, 0.48f, 0.48f), slab = world.BoxOf(0.48f, 0.09f, 0.48f);
    for (int i = 0; i < kLost; ++i) {
        const Position waiting(2.0 * (i % 11), kDepot, 2.0 * (i / 11));
        world.watched.push_back(world.Add({.shape = i < 25 ? slab : cube, .position = waiting, .startAsleep = true}));
    }
}

void AddRain(SceneWorld& world) {
    const std::array<ShapePtr, 4> kinds{world.BoxOf(0.4f, 0.3f, 0.5f), world.SphereOf(0.4f),
                                        world.CapsuleOf(0.4f, 0.25f), Prism(world, 5, 0.6f, 0.3f)};
    constexpr int kAcross = 20;
    for (int i = 0; i < kAcross * kAcross; ++i) {
        const double x = world.random.Between(-1, 1), y = world.random.Between(14, 30), z = world.random.Between(-1, 1);
        const Position at(kStreet * (i % kAcross - kAcross / 2 + 0.5) + x, y,
                          kStreet * (i / kAcross - kAcross / 2 + 0.5) + z);
        world.Add({.shape = kinds[static_cast<size_t>(i % 4)],
                   .position = at,
                   .rotation = RotationAbout(Vector3(0.6f, 0, 0.8f), y)});
    }
}

void Build(SceneWorld& world) {
    world.AddFloor(150, 150);
    AddDistricts(world);
    AddTower(world);
    AddRain(world);
}

int LostAfter(int steps) { return steps < kFirstStep ? 0 : std::min((steps - kFirstStep) / kStepsBetween + 1, kLost); }

void LoseAPiece(SceneWorld& world, double) {
    const int piece = LostAfter(world.StepCount()) - 1;
    if (piece < 0 || piece == LostAfter(world.StepCount() - 1) - 1) return;
    const BodyId tower = world.watched[0], body = world.watched[1 + kOnTheRoof + static_cast<size_t>(piece)];
    const ChildId child{static_cast<uint32_t>(piece), 0};
    const MutableCompound& compound = *world.Bodies().GetChildren(tower);
    const Vector3 at = compound.SettingsOf(compound.Children()[child.index]).position;
    (void)world.Bodies().RemoveChild(tower, child);
    (void)world.Bodies().SetPose(body, at.cast<double>(), Quaternion{});
    (void)world.Bodies().SetVelocity(body, Vector3(at.x(), 0, at.z()), Vector3::Zero());
}

// Counts pieces that are in the wrong state, bodies of the roof that are still up there when the tower is gone, and
// bodies below the ground.
double Accuracy(const SceneWorld& world) {
    const int lost = LostAfter(world.StepCount() - 1);
    int wrong =
        std::abs(static_cast<int>(world.Bodies().GetChildren(world.watched[0])->Count()) - (25 + 16 * kStories - lost));
    for (size_t i = 1; i <= kOnTheRoof; ++i)
        if (lost == kLost && world.Bodies().GetCenterOfMass(world.watched[i]).y() > kTop - 2) ++wrong;
    return wrong + BodiesBelowTheFloor(world) - (kLost - lost);
}

}  // namespace

extern const Scene kScene{
    .name = "compound_city",
    .description =
        "bodies fall on 3456 buildings in 24 compounds; a tower, one mutable compound, loses its pieces one by one",
    .steps = 720,
    .usesSeed = true,
    .view = {.color = ColorMode::Plain,
             .from = {0.5f, 0.5f, 1},
             .lower = {-11, 0, -11},
             .upper = {11, 14, 11},
             .picture = 0.6},
    .build = Build,
    .beforeStep = LoseAPiece,
    .accuracy = Accuracy,
    .accuracyMeaning =
        "pieces of the tower, bodies on its roof and bodies in the ground that are where they should not be",
    .accuracyUnit = "pieces and bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::CompoundCityScene
