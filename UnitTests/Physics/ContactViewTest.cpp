// Contacts as the user sees them after a step: where and in which direction bodies touch, whatever they turned by.
#include <Fulcrum/Collision/Shapes/Plane.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/TestWorld.h>

#include <cmath>

namespace fulcrum::testing {
namespace {

ShapePtr Field() {
    const Vector3 corners[] = {{-50, 0, -50}, {50, 0, -50}, {50, 0, 50}, {-50, 0, 50}};
    const uint32_t indices[] = {0, 2, 1, 0, 3, 2};
    return TriangleMesh::Create({.vertices = corners, .indices = indices}).Value();
}

// They turn by a third of a radian a step; the point that touches stays below the center.
TEST(ContactView, WhatRollsTouchesBelowItsCenter) {
    const struct {
        const char* what;
        ShapePtr shape;
        double y;
    } grounds[] = {
        {"box", BoxOf(50, 1, 50), -1}, {"mesh", Field(), 0}, {"plane", Plane::Create({0, 1, 0}, 0).Value(), 0}};
    const ShapePtr compound =
        CompoundOf({{.shape = SphereOf(0.5f)}, {.shape = SphereOf(0.1f), .position = {0.1f, 0, 0}}});
    for (const auto& ground : grounds)
        for (const ShapePtr& shape : {SphereOf(0.5f), CapsuleOf(1, 0.5f), compound}) {
            TestWorld world;
            world.Add({.shape = ground.shape, .motion = MotionType::Static, .position = {0, ground.y, 0}});
            const BodyId body = world.Add({.shape = shape,
                                           .position = {-10, 0.5, 0},
                                           .rotation = RotationAbout({1, 0, 0}, 90 * kDegree),
                                           .linearVelocity = {10, 0, 0},
                                           .angularVelocity = {0, 0, -20}});
            int seen = 0;
            for (int step = 0; step < 60; ++step) {
                world.Step();
                const Position center = world.PositionOf(body);
                world.System().VisitContacts([&](const ContactView& contact) {
                    ++seen;
                    EXPECT_NEAR(contact.normal.y(), -1, 1e-4) << ground.what;
                    for (const ContactView::Point& point : contact.points) {
                        EXPECT_NEAR(point.position.x(), center.x(), 5e-3) << ground.what;
                        EXPECT_NEAR(point.position.y(), 0, 1e-3) << ground.what;
                        EXPECT_NEAR(point.separation, 0, 1e-3f) << ground.what;
                    }
                });
            }
            EXPECT_GE(seen, 50) << ground.what;
        }
}

// A ball that spins beside one that rests, against which it is pressed.
TEST(ContactView, TheNormalOfASpinningBallIsThatOfTheCenters) {
    TestWorld world(NoGravity());
    const BodyId spins = world.Add({.shape = SphereOf(0.5f),
                                    .position = {0, 0, 0},
                                    .linearVelocity = {1, 0, 0},
                                    .angularVelocity = {0, 30, 0},
                                    .material = {.friction = 0}});
    const BodyId rests = world.Add({.shape = SphereOf(0.5f), .position = {1.001, 0, 0}, .material = {.friction = 0}});
    int seen = 0;
    for (int step = 0; step < 5; ++step) {
        world.Step();
        const Position between = world.PositionOf(rests) - world.PositionOf(spins);
        world.System().VisitContacts([&](const ContactView& contact) {
            ++seen;
            const double sign = contact.bodyA == spins ? 1 : -1;
            EXPECT_NEAR(sign * double{contact.normal.x()}, 1, 1e-4);
            EXPECT_NEAR(contact.points[0].separation, Length(between.cast<float>()) - 1, 1e-4f);
        });
    }
    EXPECT_GE(seen, 1);
}

}  // namespace
}  // namespace fulcrum::testing
