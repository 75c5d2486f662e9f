#include <Fulcrum/Samples/Scenes/Scenes.h>

#include <iterator>

namespace fulcrum {

// A line a scene; each is `NameScene::kScene`, defined in the file of its name. A namespace a file, so that several can
// be compiled at once.
// clang-format off
#define FULCRUM_SCENES(scene) \
    scene(Pyramid)            \
    scene(LargePyramid)       \
    scene(ManyPyramids)       \
    scene(JointGrid)          \
    scene(ConvexOnMesh)       \
    scene(Rays)               \
    scene(Ragdolls)           \
    scene(HighSpeed)          \
    scene(HullPile)           \
    scene(Drum)               \
    scene(MostlyAsleep)       \
    scene(Tower)              \
    scene(Dominoes)           \
    scene(CardHouse)          \
    scene(WreckingPile)       \
    scene(FrictionRamp)       \
    scene(RestitutionRow)     \
    scene(Gyroscope)          \
    scene(Bowls)              \
    scene(GravityFactors)     \
    scene(ConvexShapes)       \
    scene(TerrainWithHoles)   \
    scene(QueryRays)          \
    scene(QueryCasts)         \
    scene(QueryOverlaps)      \
    scene(QueryClosest)       \
    scene(QueryBounds)        \
    scene(FlatLand)           \
    scene(Thin)               \
    scene(EndlessSlope)       \
    scene(MovingPlatforms)    \
    scene(Harbor)             \
    scene(ConveyorBelt)       \
    scene(Layers)             \
    scene(HeavyOnLight)       \
    scene(Structures)         \
    scene(TrapDoor)           \
    scene(CompoundCity)       \
    scene(Sensors)            \
    scene(Bullets)            \
    scene(BreakingGlass)      \
    scene(RagdollDrive)       \
    scene(Hinge)              \
    scene(Slider)             \
    scene(Distance)           \
    scene(Cone)               \
    scene(SwingTwist)         \
    scene(SixDof)             \
    scene(Gears)              \
    scene(RackAndPinion)      \
    scene(Pulley)             \
    scene(Path)               \
    scene(Wheel)              \
    scene(Bridge)             \
    scene(Rope)               \
    scene(HeavyChain)         \
    scene(NewtonsCradle)      \
    scene(DoublePendulum)     \
    scene(Springs)            \
    scene(OverconstrainedDoor)
// clang-format on

#define FULCRUM_DECLARE(Name)      \
    namespace Name##Scene {        \
        extern const Scene kScene; \
    }
FULCRUM_SCENES(FULCRUM_DECLARE)
#undef FULCRUM_DECLARE

namespace {

#define FULCRUM_LIST(Name) &Name##Scene::kScene,
const Scene* const kScenes[] = {FULCRUM_SCENES(FULCRUM_LIST)};
#undef FULCRUM_LIST
#undef FULCRUM_SCENES

}  // namespace

std::span<const Scene* const> AllScenes() { return kScenes; }

const Scene* FindScene(std::string_view name) {
    for (const Scene* scene : kScenes)
        if (name == scene->name) return scene;
    return nullptr;
}

}  // namespace fulcrum
