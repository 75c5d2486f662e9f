#include <Fulcrum/Math/Trigonometry.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

namespace fulcrum::CardHouseScene {
namespace {

constexpr double kHalfLength = 0.5, kHalfWidth = 0.35, kHalfThickness = 0.02;  // m, of a leaning card
constexpr double kLean = 20 * kDegree;                                         // from the vertical
constexpr double kPitch = 0.8;                                                 // m, between the tents of a story
constexpr int kStories = 4;

// Two cards that lean against each other over x = middle, their feet at height `ground`. Returns the height of their
// upper edges: of a card turned by kLean, half the height is L cos + t sin, and its inner upper edge is t cos + L sin
// beside the center.
double AddTent(SceneWorld& world, const ShapePtr& card, double middle, double ground, const Material& material) {
    const double sine = Sin(kLean), cosine = Cos(kLean);
    const double halfHeight = kHalfLength * cosine + kHalfThickness * sine;
    const double aside = kHalfLength * sine + kHalfThickness * cosine;
    for (double side : {-1.0, 1.0})
        world.Add({.shape = card,
                   .position = {middle + side * aside, ground + halfHeight, 0},
                   .rotation = RotationAbout(Vector3(0, 0, 1), side * kLean),
                   .material = material});
    return ground + 2 * halfHeight;
}

void Build(SceneWorld& world) {
    const Material paper{.friction = 0.7f};
    world.Add(
        {.shape = world.BoxOf(10, 1, 10), .motion = MotionType::Static, .position = {0, -1, 0}, .material = paper});
    const ShapePtr leaning = world.BoxOf(float(kHalfThickness), float(kHalfLength), float(kHalfWidth));
    // Flat cards reach from tent to tent, where two of them meet.
    const ShapePtr flat = world.BoxOf(float(kPitch / 2 - 0.002), float(kHalfThickness), float(kHalfWidth));

    double ground = 0;
    for (int tents = kStories; tents > 0; --tents) {
        const double first = -0.5 * kPitch * (tents - 1);
        double top = ground;
        for (int i = 0; i < tents; ++i) top = AddTent(world, leaning, first + kPitch * i, ground, paper);
        for (int i = 0; i + 1 < tents; ++i)
            world.watched.push_back(world.Add(
                {.shape = flat, .position = {first + kPitch * (i + 0.5), top + kHalfThickness, 0}, .material = paper}));
        ground = top + 2 * kHalfThickness;
    }
}

double HeightOfTheHighestFlatCard() {
    const double story = 2 * (kHalfLength * Cos(kLean) + kHalfThickness * Sin(kLean)) + 2 * kHalfThickness;
    return (kStories - 1) * story - kHalfThickness;
}

double Accuracy(const SceneWorld& world) {
    return world.Bodies().GetPose(world.watched.back()).position.y() - HeightOfTheHighestFlatCard();
}

}  // namespace

extern const Scene kScene{
    .name = "card_house",
    .description = "a house of cards of four stories that stands by friction alone",
    .steps = 600,
    .isBuiltToStand = true,
    .isClosed = true,
    .view = {.color = ColorMode::Plain, .from = {0.35f, 0.15f, 1}},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "height of the highest flat card minus where it was laid",
    .accuracyUnit = "m",
    // Four stories settle by a contact each of 1 mm, and lean by what friction gives: less than half a card's
    // thickness.
    .accuracyRange = {{-0.02, 0.02}},
};

}  // namespace fulcrum::CardHouseScene
