#include <Fulcrum/UnitTests/Support/Drops.h>

#include <Fulcrum/Collision/Shapes/ConvexHull.h>
#include <Fulcrum/Collision/Shapes/Primitives.h>
#include <Fulcrum/Collision/Shapes/TriangleMesh.h>
#include <Fulcrum/UnitTests/Support/RandomPoses.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <vector>

namespace fulcrum::testing {

namespace {

constexpr float kHalfGround = 40;  // m
constexpr double kApart = 12;      // m, between the groups of a world
constexpr uint32_t kColumns = 5;   // groups in a row: all lie within the ground
constexpr uint32_t kGroups = kColumns * kColumns;

template <class T>
T Must(Result<T> result) {
    if (!result) std::abort();
    return std::move(result.Value());
}
void Must(const Status& status) {
    if (!status) std::abort();
}

// `longest`: times this for rods.
ShapePtr RandomShape(RandomPoses& random, float longest) {
    const uint32_t which = random.Below(4);
    const float size = random.Between(0.1f, 1) * (which == 0 ? longest : 1.0f);
    const auto part = [&](float least, float most) { return size * random.Between(least, most); };
    switch (which) {
        case 0: return Must(Box::Create(Vector3{part(0.0125f, 0.1f), size, part(0.0125f, 0.1f)}));
        case 1: return Must(Box::Create(Vector3{part(0.02f, 0.1f), size, part(0.1f, 1)}));
        case 2: return Must(Box::Create(Vector3{part(0.3f, 1), part(0.3f, 1), part(0.3f, 1)}));
        default: break;
    }
    const Vector3 half{size, part(0.1f, 1), part(0.1f, 1)};
    std::vector<Vector3> points;
    for (uint32_t i = 0; i < 12; ++i) points.push_back(random.InCube().cwiseProduct(half));
    return Must(ConvexHull::Create(points));
}

class DropWorld {
public:
    explicit DropWorld(const DropSettings& settings)
        : settings_(settings), material_{.friction = settings.friction, .restitution = settings.restitution} {
        SystemSettings system;
        system.solver.substeps = settings.substeps;
        if (settings.ground == DropGround::Air) system.gravity.setZero();
        gravity_ = -double{system.gravity.y()};
        system_ = Must(PhysicsSystem::Create(system, nullptr));
        if (settings.ground == DropGround::Air) return;
        const bool isFloor = settings.ground == DropGround::Floor;
        const ShapePtr shape = isFloor ? ShapePtr(Must(Box::Create(Vector3(kHalfGround, 1, kHalfGround))))
                                       : HillyGround(settings.ground == DropGround::Hills ? 0.5f : 0.0f);
        Must(system_->Bodies().Create({.shape = shape,
                                       .motion = MotionType::Static,
                                       .position = {0, isFloor ? -1.0 : 0.0, 0},
                                       .material = material_}));
    }

    void AddGroup(uint32_t place, uint32_t seed) {
        const auto along = [](uint32_t i) { return kApart * i - 0.5 * kApart * (kColumns - 1); };
        RandomPoses random(seed);
        const Position middle(along(place % kColumns), 0, along(place / kColumns));
        std::vector<BodyId> group;
        for (int i = 0; i < settings_.together; ++i) group.push_back(AddBody(random, middle, i));
        groups_.push_back(std::move(group));
        first_.push_back(EnergyOf(groups_.size() - 1));
        least_.push_back(first_.back());
    }

    void Step() { Must(system_->Update(settings_.dt)); }

    void Note(uint32_t firstSeed, uint32_t step, DropEnergy& worst) {
        for (size_t i = 0; i < groups_.size(); ++i) {
            const double energy = EnergyOf(i), most = energy / first_[i], gain = (energy - least_[i]) / first_[i];
            const uint32_t seed = firstSeed + static_cast<uint32_t>(i);
            least_[i] = std::min(least_[i], energy);
            worst.finite &= std::isfinite(energy);
            if (most > worst.most) worst.most = most, worst.drop = seed, worst.step = step;
            if (gain > worst.gain) worst.gain = gain, worst.gainingDrop = seed;
        }
    }

private:
    // In the air all fly towards the middle of their group; else they start one above the other. Groups do not collide
    // with each other.
    BodyId AddBody(RandomPoses& random, const Position& middle, int i) {
        const ShapePtr shape = RandomShape(random, settings_.together == 1 ? 4.0f : 1.0f);
        const float reach = shape->OuterRadius();
        const Quaternion rotation = random.Rotation();
        const Vector3 velocity = random.InBox(5), axis = random.InCube();
        const float spin = random.Chance(0.5f) ? random.Between(0, 20) : 0.0f;
        BodySettings body{.shape = shape,
                          .rotation = rotation,
                          .linearVelocity = velocity,
                          .angularVelocity = axis * spin,
                          .material = material_,
                          .continuous = settings_.kind};
        body.category = uint64_t(2) << groups_.size();
        body.mask = body.category | 1;
        if (settings_.ground == DropGround::Air) {
            const Vector3 from = OnRing(i, 3.2f) + random.InBox(0.3f);
            body.position = middle + from.cast<double>();
            body.linearVelocity = from * -random.Between(1, 6) + velocity * 0.1f;
        } else {
            body.position = middle + Position(0, height_ + double{reach} + double{random.Between(0.5f, 3)}, 0);
            height_ = body.position.y() + double{reach};
            if (i + 1 == settings_.together) height_ = 1;
            if (settings_.together > 1)
                body.linearVelocity = Vector3(0.1f * velocity.x(), -2.0f * static_cast<float>(i), 0.1f * velocity.z());
        }
        return Must(system_->Bodies().Create(body));
    }
    // Apart from each other by more than they are long.
    Vector3 OnRing(int i, float radius) const {
        const Vector3 places[] = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {0, -1, 0}};
        return places[i % 6] * radius;
    }

    double EnergyOf(size_t group) const {
        const BodyInterface& bodies = system_->Bodies();
        double sum = 0;
        for (const BodyId id : groups_[group])
            sum += bodies.GetKineticEnergy(id) + double{bodies.GetMass(id)} * gravity_ * bodies.GetCenterOfMass(id).y();
        return sum;
    }

    DropSettings settings_;
    Material material_;
    double gravity_ = 0, height_ = 1;  // m/s2; m
    std::unique_ptr<PhysicsSystem> system_;
    std::vector<std::vector<BodyId>> groups_;
    std::vector<double> first_, least_;  // J, by group
};

}  // namespace

ShapePtr HillyGround(float height) {
    constexpr uint32_t kCells = 40;
    std::vector<Vector3> vertices;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i <= kCells; ++i)
        for (uint32_t k = 0; k <= kCells; ++k) {
            vertices.emplace_back(2.0f * static_cast<float>(i) - kHalfGround, (i + 2 * k) % 5 == 0 ? height : 0.0f,
                                  2.0f * static_cast<float>(k) - kHalfGround);
            const uint32_t a = i * (kCells + 1) + k, b = a + kCells + 1;
            if (i < kCells && k < kCells) indices.insert(indices.end(), {a, a + 1, b, b, a + 1, b + 1});
        }
    return Must(TriangleMesh::Create({.vertices = vertices, .indices = indices}));
}

std::string NameOf(const DropSettings& s) {
    constexpr const char *kGrounds[] = {"floor", "mesh", "hills", "air"},
                         *kKinds[] = {"Off", "Linear", "LinearAndAngular"};
    std::ostringstream name;
    name << kGrounds[static_cast<int>(s.ground)] << ", " << s.together << " of " << kKinds[static_cast<int>(s.kind)]
         << ", restitution " << s.restitution << ", friction " << s.friction << ", " << s.substeps << " substeps, dt 1/"
         << std::lround(1 / s.dt);
    return name.str();
}

DropEnergy EnergyOfDrops(const DropSettings& settings, uint32_t first, uint32_t drops, double seconds) {
    DropEnergy worst;
    for (uint32_t done = 0; done < drops; done += kGroups) {
        DropWorld world(settings);
        for (uint32_t i = 0; i < std::min(kGroups, drops - done); ++i) world.AddGroup(i, first + done + i);
        const uint32_t steps = static_cast<uint32_t>(std::lround(seconds / settings.dt));
        for (uint32_t step = 0; step < steps; ++step) {
            world.Step();
            world.Note(first + done, step, worst);
        }
    }
    return worst;
}

}  // namespace fulcrum::testing
