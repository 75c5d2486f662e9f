// A pyramid of six crates falls a hand's breadth onto a floor; two seconds later their heights are printed.
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Physics/PhysicsSystem.h>

#include <cstdio>
#include <vector>

using namespace fulcrum;

int main() {
    auto world = PhysicsSystem::Create().Value();
    BodyInterface& bodies = world->Bodies();

    const ShapePtr floor = Box::Create({20, 1, 20}).Value();  // half extents, m
    const ShapePtr crate = Box::Create({0.5f, 0.5f, 0.5f}).Value();
    bodies.Create({.shape = floor, .motion = MotionType::Static, .position = {0, -1, 0}}).Value();

    std::vector<BodyId> crates;
    for (int row = 0; row < 3; ++row)
        for (int column = row; column < 3; ++column)
            crates.push_back(
                bodies.Create({.shape = crate, .position = {1.1 * column - 0.55 * row, 0.6 + 1.1 * row, 0}}).Value());

    for (int step = 0; step < 120; ++step)
        if (Status status = world->Update(1.0 / 60); !status) {
            std::fprintf(stderr, "%s\n", status.GetError().message.c_str());
            return 1;
        }
    for (BodyId id : crates) std::printf("crate %u: height %.2f m\n", id.index, bodies.GetPose(id).position.y());
}
