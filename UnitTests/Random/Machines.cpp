#include <Fulcrum/UnitTests/Random/Machines.h>

#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/UnitTests/Random/Controls.h>

#include <algorithm>
#include <cmath>

namespace fulcrum::testing {

namespace {

constexpr float kHalfThickness = 0.02f, kWeightRadius = 0.05f;  // m
constexpr double kShortest = 0.3;                               // m, of a rod

// The least rotation that turns x to a unit vector.
Quaternion FromX(const Position& u) {
    const double w = 1 + u.x();
    if (w < 1e-6) return {0, 0, 1, 0};
    const double scale = 1 / std::sqrt(w * w + u.y() * u.y() + u.z() * u.z());
    return Normalized(Quaternion{0, static_cast<float>(-u.z() * scale), static_cast<float>(u.y() * scale),
                                 static_cast<float>(w * scale)});
}

class MachineMaker {
public:
    MachineMaker(MachineKind kind, uint64_t seed)
        : random_(RandomOf(seed)), isFlat_(kind == MachineKind::Plane), isParallel_(isFlat_ || random_.Chance(0.5f)) {}

    Mechanism Make() {
        const uint32_t rods = 2 + random_.Below(6);
        size_t node = AddNode();
        for (uint32_t i = 0; i < rods; ++i) {
            AddRod(node, FindEnd(node));
            node = AnyNode();
        }
        if (random_.Chance(0.8f)) AddWeight(AnyNode());
        if (random_.Chance(0.6f)) {
            const uint32_t anchors = 1 + random_.Below(2);
            for (uint32_t i = 0; i < anchors; ++i) {
                const Node& anchored = nodes_[AnyNode()];
                Pin(kWorldBody, OneOf(anchored), anchored.place);
            }
        }
        return std::move(machine_);
    }

private:
    struct Node {
        Position place;
        std::vector<BodyId> bodies;
        std::vector<size_t> neighbors;
    };

    size_t AnyNode() { return random_.Below(static_cast<uint32_t>(nodes_.size())); }
    BodyId OneOf(const Node& node) { return node.bodies[random_.Below(static_cast<uint32_t>(node.bodies.size()))]; }
    bool IsFar(const Position& place) const {
        return std::all_of(nodes_.begin(), nodes_.end(),
                           [&](const Node& node) { return (place - node.place).norm() > kShortest; });
    }
    // In whole centimeters, so that it may be written down.
    double Coordinate() { return (static_cast<double>(random_.Below(401)) - 200) / 100; }
    size_t AddNode() {
        for (;;) {
            const double x = Coordinate(), y = Coordinate();
            const Position place(x, y, isFlat_ ? 0 : Coordinate());
            if (!IsFar(place)) continue;
            nodes_.push_back({place, {}, {}});
            return nodes_.size() - 1;
        }
    }
    // One that is there already closes a loop.
    size_t FindEnd(size_t from) {
        if (random_.Chance(0.4f)) {
            const size_t other = AnyNode();
            const std::vector<size_t>& known = nodes_[from].neighbors;
            if (other != from && std::find(known.begin(), known.end(), other) == known.end()) return other;
        }
        return AddNode();
    }

    BodyId AddBody(const ShapePtr& shape, const Position& place, const Quaternion& rotation, float mass) {
        machine_.bodies.push_back({.shape = shape, .position = place, .rotation = rotation, .mass = mass, .mask = 0});
        return BodyBatch::Body(static_cast<uint32_t>(machine_.bodies.size() - 1));
    }
    void AddRod(size_t from, size_t to) {
        const Position a = nodes_[from].place, b = nodes_[to].place;
        const double length = (b - a).norm();
        const Vector3 half(static_cast<float>(length / 2), kHalfThickness, kHalfThickness);
        const BodyId rod = AddBody(Box::Create(half).Value(), (a + b) * 0.5, FromX(Position((b - a) / length)), 1);
        for (const size_t end : {from, to}) Attach(rod, end);
        nodes_[from].neighbors.push_back(to);
        nodes_[to].neighbors.push_back(from);
    }
    void AddWeight(size_t node) {
        const float mass = LogBetween(random_, 3, 500);
        Attach(AddBody(Sphere::Create(kWeightRadius).Value(), nodes_[node].place, {}, mass), node);
    }
    // To one of the bodies that are there.
    void Attach(BodyId body, size_t at) {
        Node& node = nodes_[at];
        if (!node.bodies.empty()) Pin(OneOf(node), body, node.place);
        node.bodies.push_back(body);
    }
    void Pin(BodyId a, BodyId b, const Position& place) {
        HingeJointSettings hinge;
        hinge.bodyA = a;
        hinge.bodyB = b;
        hinge.anchorA.point = place;
        if (random_.Chance(0.5f)) {
            machine_.joints.push_back(Of<PointJointSettings>(hinge));
            return;
        }
        hinge.anchorA.axis = isParallel_ ? Vector3(0, 0, 1) : random_.Direction();
        hinge.angle = RandomControl(random_, 2);
        machine_.joints.push_back(hinge);
    }

    RandomPoses random_;
    const bool isFlat_, isParallel_;  // all in a plane; all hinges along z
    Mechanism machine_;
    std::vector<Node> nodes_;
};

}  // namespace

Mechanism RandomMachine(MachineKind kind, uint64_t seed) { return MachineMaker(kind, seed).Make(); }

}  // namespace fulcrum::testing
