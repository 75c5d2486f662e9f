// Ray casts against single shapes and a world of bodies, compared to brute force; shape casts; the cost of the world's
// lock.
#include <Fulcrum/Collision/Queries/ShapeCast.h>
#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <benchmark/benchmark.h>

namespace fulcrum {
namespace {

using testing::RandomPoses;

ShapePtr MakeHull(RandomPoses& random, int points) {
    std::vector<Vector3> cloud;
    for (int i = 0; i < points; ++i) cloud.push_back(Normalized(random.InCube()) * 0.5f);
    return ConvexHull::Create(cloud).Value();
}

std::vector<ShapePtr> Shapes() {
    RandomPoses random(1);
    return {Sphere::Create(0.5f).Value(),
            Box::Create(Vector3(0.5f, 0.4f, 0.3f)).Value(),
            Box::Create(Vector3(0.5f, 0.4f, 0.3f), 0.1f).Value(),
            Capsule::Create(0.3f, 0.3f).Value(),
            MakeHull(random, 12),
            MakeHull(random, 32)};
}

// Most rays hit the shape.
void RayAtShape(benchmark::State& state) {
    const ShapePtr shape = Shapes()[static_cast<size_t>(state.range(0))];
    RandomPoses random(1);
    std::vector<Ray> rays;
    for (int i = 0; i < 1024; ++i) {
        const Vector3 to = random.InCube() * 0.4f, from = Normalized(random.InCube()) * 5;
        rays.push_back({from.cast<double>(), (to - from) * 2});
    }
    size_t i = 0;
    for (auto _ : state) {
        RayHit hit;
        benchmark::DoNotOptimize(CastRay(*shape, rays[i++ % rays.size()], {}, hit));
    }
    state.SetLabel(ShapeTypeName(shape->Type()));
}
BENCHMARK(RayAtShape)->DenseRange(0, 5);

// Linear and turning.
void CastAtShape(benchmark::State& state) {
    const std::vector<ShapePtr> shapes = Shapes();
    const ConvexShape& moving = static_cast<const ConvexShape&>(*shapes[static_cast<size_t>(state.range(0))]);
    const bool turns = state.range(1) != 0;
    RandomPoses random(1);
    std::vector<ShapeMotion> motions;
    for (int i = 0; i < 1024; ++i) {
        const Vector3 to = random.InCube() * 0.5f, from = Normalized(random.InCube()) * 4;
        motions.push_back({{from.cast<double>(), random.Rotation()},
                           (to - from) * 1.5f,
                           turns ? Vector3(random.InCube()) : Vector3(Vector3::Zero())});
    }
    size_t i = 0;
    for (auto _ : state) {
        ShapeHit hit;
        const ShapeCaster caster(moving, motions[i++ % motions.size()]);
        benchmark::DoNotOptimize(caster.CastClosest(*shapes[5], {}, {}, hit));
    }
    state.SetLabel(std::string(ShapeTypeName(moving.Type())) + " at a hull, " + (turns ? "turning" : "straight"));
}
BENCHMARK(CastAtShape)->ArgsProduct({{0, 1, 3, 5}, {0, 1}});

// The ground and 1764 hulls spread over it, as in the scene `rays`, and as many rays from above.
struct Field {
    Result<std::unique_ptr<PhysicsSystem>> created = PhysicsSystem::Create();
    PhysicsSystem* world = created.Value().get();
    std::vector<Ray> rays;
    std::vector<BodyId> bodies;

    Field() {
        RandomPoses random(1);
        const auto add = [&](const ShapePtr& shape, const Position& at, MotionType motion) {
            BodySettings settings;
            settings.shape = shape;
            settings.motion = motion;
            settings.position = at;
            settings.rotation = motion == MotionType::Static ? Quaternion{} : random.Rotation();
            bodies.push_back(world->Bodies().Create(settings).Value());
        };
        add(Box::Create(Vector3(200, 1, 200)).Value(), Position(0, -1, 0), MotionType::Static);
        for (int i = 0; i < 1764; ++i)
            add(MakeHull(random, 16), Position(i % 42 * 7.0 - 147, 0.5, i / 42 * 7.0 - 147), MotionType::Dynamic);
        static_cast<void>(world->Update(1e-6));
        for (int i = 0; i < 16384; ++i) {
            const float x = random.Between(-150, 150), z = random.Between(-150, 150);
            rays.push_back({Position(x, 60, z), Vector3(0, -120, 0)});
        }
    }
};

void RayAtWorld(benchmark::State& state) {
    const Field field;
    size_t i = 0, hits = 0;
    const auto run = [&] {
        for (auto _ : state) {
            WorldRayHit hit;
            hits += field.world->Queries().CastRay(field.rays[i++ % field.rays.size()], hit);
        }
    };
    if (state.range(0) != 0) {
        const WorldLock::Shared held = field.world->Queries().Hold();
        run();
    } else {
        run();
    }
    if (hits < i) state.SkipWithError("a ray missed the ground");
    state.SetLabel(state.range(0) != 0 ? "held" : "one by one");
}
BENCHMARK(RayAtWorld)->Arg(0)->Arg(1);

void RayAtAllBodies(benchmark::State& state) {
    const Field field;
    size_t i = 0;
    for (auto _ : state) {
        const RayCaster caster(field.rays[i++ % field.rays.size()]);
        RayCastSettings settings;
        RayHit hit;
        for (const BodyId id : field.bodies) {
            const Pose pose{field.world->Bodies().GetCenterOfMass(id), field.world->Bodies().GetPose(id).rotation};
            if (caster.CastClosest(*field.world->Bodies().GetShape(id), pose, settings, hit))
                settings.maxFraction = hit.fraction;
        }
        benchmark::DoNotOptimize(hit);
    }
}
BENCHMARK(RayAtAllBodies);

// From above, which is cast in packets, and in all directions, which is not.
void BatchOfRays(benchmark::State& state) {
    Field field;
    RandomPoses random(2);
    if (state.range(0) != 0) {
        for (Ray& ray : field.rays) {
            ray.origin.y() = 5;
            ray.displacement = random.Direction() * 50;
        }
    }
    std::vector<WorldRayHit> hits(field.rays.size());
    for (auto _ : state) field.world->Queries().CastRays(field.rays, hits);
    state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(hits.size()));
    state.SetLabel(state.range(0) != 0 ? "in all directions" : "from above");
}
BENCHMARK(BatchOfRays)->Arg(0)->Arg(1);

// The cost of the write lock for a change of a single body.
void ChangeABody(benchmark::State& state) {
    Field field;
    for (auto _ : state) benchmark::DoNotOptimize(field.world->Bodies().SetGravityFactor(field.bodies[1], 1));
}
BENCHMARK(ChangeABody);

}  // namespace
}  // namespace fulcrum
