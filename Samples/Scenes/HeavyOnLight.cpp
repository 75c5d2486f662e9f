#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <cmath>

namespace fulcrum::HeavyOnLightScene {
namespace {

constexpr int kBoxes = 10;
constexpr float kLight = 10, kHeavy = 1000;  // kg
constexpr double kApart = 12;                // m, between the two stacks

// In the stack at x > 0 the lower body of each contact counts as a tenth as easy to move.
class HeavierBelow final : public ContactListener {
    void ModifyContact(const ContactView& contact, ContactChange& change) const override {
        if (contact.Center().x() < 0) return;
        change.ScaleInverseMass(contact, contact.normal.y() > 0 ? contact.bodyA : contact.bodyB, 0.1f);
    }
};

void Build(SceneWorld& world) {
    world.AddFloor(20, 20);
    world.Listen(std::make_unique<HeavierBelow>());
    const ShapePtr cube = world.BoxOf(0.5f, 0.5f, 0.5f);
    for (double side : {-1.0, 1.0})
        for (int i = 0; i < kBoxes; ++i)
            world.watched.push_back(world.Add({.shape = cube,
                                               .position = {side * kApart / 2, 0.5 + i, 0},
                                               .mass = i + 1 < kBoxes ? kLight : kHeavy}));
}

// Of the stack at x > 0.
double Accuracy(const SceneWorld& world) {
    return world.Bodies().GetPose(world.watched.back()).position.y() - (kBoxes - 0.5);
}

}  // namespace

extern const Scene kScene{
    .name = "heavy_on_light",
    .description = "a tonne on boxes of 10 kg: the stack stands where lower bodies are heavier for their contacts",
    .steps = 600,
    .view = {.color = ColorMode::Plain, .from = {0.3f, 0.15f, 1}, .picture = 0.3},
    .build = Build,
    .accuracy = Accuracy,
    .accuracyMeaning = "height of that stack's top box minus 9.5 m, that of a perfect stack",
    .accuracyUnit = "m",
    // Ten contacts of a millimeter each; the other stack is scattered on the floor.
    .accuracyRange = {{-0.01, 0.001}},
};

}  // namespace fulcrum::HeavyOnLightScene
