#include <Fulcrum/Collision/Shapes/HeightField.h>
#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <array>
#include <utility>

namespace fulcrum::TerrainWithHolesScene {
namespace {

constexpr uint32_t kCells = 64;
constexpr float kCell = 0.5f;                        // m
constexpr float kHalf = 0.5f * kCell * kCells;       // m
constexpr int kOpens = 300;                          // step after which the middle opens
constexpr uint32_t kMiddle = kCells / 2, kTrap = 4;  // cells: half the width of the opening
constexpr uint8_t kGrass = 0, kIce = 1, kRubber = 2;

// A valley along z with ripples, 3 to 9 m above the floor.
float HeightAt(uint32_t x, uint32_t z) {
    const double u = 2.0 * x / kCells - 1, v = 2.0 * z / kCells - 1;
    return static_cast<float>(3.5 + 4 * u * u + 1.2 * v * v + 0.25 * Sin(14 * u) * Cos(11 * v));
}

// Two ponds of ice and a strip of rubber on the slopes, six holes in the valley.
uint8_t CellAt(uint32_t x, uint32_t z) {
    const auto isWithin = [&](uint32_t midX, uint32_t midZ, uint32_t half) {
        return x + half >= midX && x < midX + half && z + half >= midZ && z < midZ + half;
    };
    for (const auto& [holeX, holeZ] : {std::pair{24u, 12u}, {40u, 20u}, {26u, 44u}, {38u, 52u}, {20u, 30u}, {46u, 36u}})
        if (isWithin(holeX, holeZ, 2)) return kHoleCell;
    if (isWithin(14, 20, 7) || isWithin(50, 46, 7)) return kIce;
    return x >= 48 && x < 54 && z < 30 ? kRubber : kGrass;
}

void Build(SceneWorld& world) {
    std::vector<float> heights;
    std::vector<uint8_t> cells;
    for (uint32_t z = 0; z <= kCells; ++z)
        for (uint32_t x = 0; x <= kCells; ++x) {
            heights.push_back(HeightAt(x, z));
            if (x < kCells && z < kCells) cells.push_back(CellAt(x, z));
        }
    const std::array<SurfaceMaterial, 3> materials{
        {{.friction = 0.7f}, {.friction = 0}, {.friction = 0.7f, .restitution = 0.9f}}};
    const auto field = HeightField::Create({.sampleCountX = kCells + 1,
                                            .sampleCountZ = kCells + 1,
                                            .heights = heights,
                                            .cellSizeX = kCell,
                                            .cellSizeZ = kCell,
                                            .origin = {-kHalf, 0, -kHalf},
                                            .cells = cells,
                                            .materials = materials});
    world.watched.push_back(world.Add({.shape = field.Value(), .motion = MotionType::Static}));
    world.ShowSurface(world.watched.back(), {Look::Grass, Look::Ice, Look::Rubber});
    world.AddFloor(kHalf + 8, kHalf + 8);
    world.AddWalls(kHalf + 6, kHalf + 6, 2);
    const std::array<ShapePtr, 4> shapes{world.SphereOf(0.3f), world.BoxOf(0.3f, 0.25f, 0.35f),
                                         world.CapsuleOf(0.25f, 0.2f), world.SphereOf(0.4f)};
    for (int i = 0; i < 144; ++i) {
        const double x = 2.4 * (i % 12 - 5.5), z = 2.4 * (i / 12 - 5.5);
        world.watched.push_back(world.Add({.shape = shapes[static_cast<size_t>(i + i / 12) % shapes.size()],
                                           .position = {x, 11 + 0.2 * (i % 5), z},
                                           .rotation = RotationAbout(Vector3(0.6f, 0, 0.8f), 0.7 * i)}));
    }
}

// The scene created the field and may edit it; others see it as const.
std::shared_ptr<HeightField> FieldOf(const SceneWorld& world) {
    return std::const_pointer_cast<HeightField>(
        std::static_pointer_cast<const HeightField>(world.Bodies().GetShape(world.watched[0])));
}

// Opens the middle: the bodies that rested there wake.
void OpenTheMiddle(SceneWorld& world, double) {
    if (world.StepCount() != kOpens) return;
    const std::vector<uint8_t> open(4 * kTrap * kTrap, kHoleCell);
    (void)FieldOf(world)->SetCells(kMiddle - kTrap, kMiddle - kTrap, 2 * kTrap, 2 * kTrap, open);
}

// Outlines of the special cells: red for holes, blue for ice, violet for rubber.
void DrawTheCells(SceneWorld& world, const HeightField& field) {
    if (!world.Draw().IsOn()) return;
    const auto compare = [&](uint8_t a, uint8_t b, const Vector3& from, const Vector3& to) {
        if (a == b) return;
        const auto is = [&](uint8_t kind) { return a == kind || b == kind; };
        const Ink ink = is(kHoleCell) ? Ink::Hit : is(kIce) ? Ink::Path : Ink::Shape;
        world.Draw().Line(from.cast<double>(), to.cast<double>(), ink);
    };
    for (uint32_t z = 0; z < kCells; ++z)
        for (uint32_t x = 0; x < kCells; ++x) {
            const uint8_t here = field.Cell(x, z);
            if (x + 1 < kCells) compare(here, field.Cell(x + 1, z), field.Vertex(x + 1, z), field.Vertex(x + 1, z + 1));
            if (z + 1 < kCells) compare(here, field.Cell(x, z + 1), field.Vertex(x, z + 1), field.Vertex(x + 1, z + 1));
        }
}

// Counts bodies whose center passes the surface where it is solid. Where the field is and its own frame are the
// world's.
void Watch(SceneWorld& world) {
    const auto field = FieldOf(world);
    for (size_t i = 1; i < world.watched.size(); ++i) {
        const Position now = world.Bodies().GetCenterOfMass(world.watched[i]);
        const double before = now.y() - double{world.Bodies().GetLinearVelocity(world.watched[i]).y()} / 60;
        SurfaceHit hit;
        const SurfaceRay down{Vector3(static_cast<float>(now.x()), 20, static_cast<float>(now.z())), Vector3(0, -20, 0),
                              false};
        if (!field->CastRay(down, hit)) continue;
        const double height = 20 - 20 * double{hit.fraction};
        if (now.y() < height && before >= height) ++world.figure;
    }
    DrawTheCells(world, *field);
}

}  // namespace

extern const Scene kScene{
    .name = "terrain_with_holes",
    .description =
        "bodies roll down a height field of grass, ice and rubber into its holes; in the middle one opens after 5 s",
    .steps = 600,
    .view = {.color = ColorMode::Plain, .from = {0.4f, 0.75f, 1}, .picture = 0.45},
    .build = Build,
    .beforeStep = OpenTheMiddle,
    .afterStep = Watch,
    .accuracy = FigureOf,
    .accuracyMeaning = "bodies that passed the surface where it is solid",
    .accuracyUnit = "bodies",
    .accuracyRange = {{0, 0}},
};

}  // namespace fulcrum::TerrainWithHolesScene
