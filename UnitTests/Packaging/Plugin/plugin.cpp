// The engine behind one C function, with two threads and queries: both keep data of a thread's own.
#include <Fulcrum/Fulcrum.h>

#include <vector>

static_assert(FULCRUM_VERSION == FULCRUM_VERSION_MAJOR * 10000 + FULCRUM_VERSION_MINOR * 100 + FULCRUM_VERSION_PATCH);

using namespace fulcrum;

extern "C" const char* EngineVersion() { return FULCRUM_VERSION_STRING; }

// The height at which a ray hits a ball that was dropped onto a floor two seconds ago, m; negative: an error.
extern "C" double TopOfDroppedBall() {
    ThreadPool pool(2);
    auto created = PhysicsSystem::Create({}, &pool);
    if (!created) return -1;
    auto world = std::move(created.Value());
    const ShapePtr floor = Box::Create({20, 1, 20}).Value(), ball = Sphere::Create(0.5f).Value();
    world->Bodies().Create({.shape = floor, .motion = MotionType::Static, .position = {0, -1, 0}}).Value();
    world->Bodies().Create({.shape = ball, .position = {0, 2, 0}}).Value();
    for (int step = 0; step < 120; ++step)
        if (!world->Update(1.0 / 60)) return -2;
    const Ray down{.origin = {0, 10, 0}, .displacement = {0, -20, 0}};
    std::vector<Ray> rays(64, down);
    std::vector<WorldRayHit> hits(rays.size());
    world->Queries().CastRays(rays, hits);
    return hits.back().position.y();
}
