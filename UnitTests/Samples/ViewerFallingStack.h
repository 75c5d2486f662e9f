// A recording computed by formulas, without the engine: a pyramid of cubes whose layers fall onto each other and come
// to rest, under a ring of one body of each other shape that fly past, turning. For the tests of the viewer.
#pragma once

#include <Fulcrum/Samples/Viewer/Recording.h>

#include <algorithm>
#include <cmath>

namespace fulcrum {

inline constexpr float kFallingStackGravity = 9.81f;

// How far the layer `i` of the pyramid is above its place at rest after `time`: it starts i/2 m above it and bounces
// once to a sixteenth of that. Velocity in m/s.
struct Fall {
    float height = 0, velocity = 0;
};

inline Fall FallOfLayer(int i, double time) {
    const double g = kFallingStackGravity, start = 0.5 * i, impact = std::sqrt(2 * start / g);
    if (time < impact) return {static_cast<float>(start - g * time * time / 2), static_cast<float>(-g * time)};
    const double speed = g * impact / 4, late = time - impact;
    if (late < 2 * speed / g)
        return {static_cast<float>(speed * late - g * late * late / 2), static_cast<float>(speed - g * late)};
    return {};
}

inline Quaternion TurnAboutY(double angle) {
    return {0, static_cast<float>(std::sin(angle / 2)), 0, static_cast<float>(std::cos(angle / 2))};
}

class FallingStack {
public:
    // `layers` of the pyramid, 1 .. 15.
    explicit FallingStack(int layers) {
        recording_.title = "falling stack";
        recording_.description = "Layers of cubes that fall onto each other by formula: no engine took part.";
        recording_.report = {{"Scene", "Layers", std::to_string(layers)}, {"Scene", "Gravity", "9.81 m/s²"}};
        AddShapes();
        AddBody(0, RecordedMotion::Static, 0, "floor", Vector3(0, -1, 0), -1);
        for (int i = 0; i < layers; ++i)
            for (int j = i / 2; j < layers - (i + 1) / 2; ++j)
                for (int k = i / 2; k < layers - (i + 1) / 2; ++k) {
                    const Vec3<int> place(-15 + 2 * j + i % 2, 1 + 2 * i, -15 + 2 * k + i % 2);
                    AddBody(1, RecordedMotion::Dynamic, 8000, "", place.cast<float>(), i);
                }
        for (uint32_t shape = 2; shape < recording_.shapes.size(); ++shape) {
            const double angle = 1.3 * shape;
            AddBody(shape, shape == 5 ? RecordedMotion::Kinematic : RecordedMotion::Dynamic, 500, "flyer",
                    Vector3(static_cast<float>(20 * std::cos(angle)), 6, static_cast<float>(20 * std::sin(angle))), -1);
        }
        recording_.report.push_back({"Scene", "Bodies", std::to_string(recording_.bodies.size())});
    }

    void AddFrames(size_t count, double dt) {
        for (size_t i = 0; i < count; ++i) AddFrame(static_cast<double>(recording_.frames.size()) * dt);
    }

    RecordedState StateAt(uint32_t body, double time) const {
        RecordedState state;
        state.body = body;
        state.position = places_[body];
        if (layers_[body] >= 0) {
            const Fall fall = FallOfLayer(layers_[body], time);
            state.position.y() += fall.height;
            state.velocity.y() = fall.velocity;
            state.awake = time < 3;
            state.island = 7;
        } else if (recording_.bodies[body].motion != RecordedMotion::Static) {
            const double angle = 0.8 * time;
            const Vector3 place = places_[body];
            state.rotation = TurnAboutY(-angle);
            state.position = Rotate(state.rotation, place);
            state.velocity = Vector3(-0.8f * state.position.z(), 0, 0.8f * state.position.x());
            state.island = static_cast<int32_t>(body);
        }
        return state;
    }

    const Recording& Get() const { return recording_; }

private:
    void AddShapes() {
        const auto add = [this](RecordedShapeKind kind, const char* name) -> RecordedShape& {
            RecordedShape& shape = recording_.shapes.emplace_back();
            shape.kind = kind;
            shape.name = name;
            return shape;
        };
        add(RecordedShapeKind::Box, "floor").halfExtents = Vector3(50, 1, 50);
        add(RecordedShapeKind::Box, "cube").halfExtents = Vector3(1, 1, 1);
        add(RecordedShapeKind::Sphere, "ball").radius = 1.2f;
        RecordedShape& capsule = add(RecordedShapeKind::Capsule, "capsule");
        capsule.radius = 0.7f;
        capsule.halfHeight = 1.2f;
        RecordedShape& hull = add(RecordedShapeKind::Hull, "tetrahedron");
        hull.vertices = {Vector3(2, 2, 2), Vector3(2, -2, -2), Vector3(-2, 2, -2), Vector3(-2, -2, 2)};
        hull.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
        RecordedShape& compound = add(RecordedShapeKind::Compound, "ball and bar");
        compound.children = {{2, {Vector3(-1.5f, 0, 0), {}}},
                             {3, {Vector3(1, 0, 0), {0, 0, 0.70710678f, 0.70710678f}}}};
    }

    void AddBody(uint32_t shape, RecordedMotion motion, float mass, const char* name, const Vector3& place, int layer) {
        RecordedBody& body = recording_.bodies.emplace_back();
        body.shape = shape;
        body.motion = motion;
        body.mass = mass;
        body.name = name;
        places_.push_back(place);
        layers_.push_back(layer);
    }

    void AddFrame(double time) {
        std::vector<RecordedState> states;
        std::vector<RecordedContact> contacts;
        for (uint32_t body = 0; body < recording_.bodies.size(); ++body) {
            states.push_back(StateAt(body, time));
            if (layers_[body] < 0 || states.back().position != places_[body]) continue;
            for (int corner = 0; corner < 4; ++corner)
                contacts.push_back({places_[body] + Vector3(corner & 1 ? 1 : -1, -1, corner & 2 ? 1 : -1),
                                    Vector3(0, 1, 0), -0.001f, 300.0f, 0, body});
        }
        AppendFrame(recording_, time, states, contacts);
    }

    Recording recording_;
    std::vector<Vector3> places_;
    std::vector<int> layers_;  // -1: not of the pyramid
};

}  // namespace fulcrum
