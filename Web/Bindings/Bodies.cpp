// Bodies and shapes: create, change, read.
#include <Fulcrum/Web/Bindings/Exchange.h>

#include <bit>

namespace fulcrum::web {

namespace {

// Changes of a body that take numbers alone, by the names that JavaScript uses.
struct Change {
    const char* name;
    Status (*apply)(BodyInterface& bodies, BodyId id, const double* n);
};
constexpr Change kChanges[] = {
    {"setPose",
     [](BodyInterface& b, BodyId id, const double* n) { return b.SetPose(id, PositionAt(n), RotationAt(n + 3)); }},
    {"moveKinematic",
     [](BodyInterface& b, BodyId id, const double* n) {
         return b.MoveKinematic(id, PositionAt(n), RotationAt(n + 3), static_cast<float>(n[7]));
     }},
    {"setVelocity",
     [](BodyInterface& b, BodyId id, const double* n) { return b.SetVelocity(id, VectorAt(n), VectorAt(n + 3)); }},
    {"addForce", [](BodyInterface& b, BodyId id, const double* n) { return b.AddForce(id, VectorAt(n)); }},
    {"addForceAt",
     [](BodyInterface& b, BodyId id, const double* n) { return b.AddForceAt(id, VectorAt(n), PositionAt(n + 3)); }},
    {"addTorque", [](BodyInterface& b, BodyId id, const double* n) { return b.AddTorque(id, VectorAt(n)); }},
    {"addImpulse", [](BodyInterface& b, BodyId id, const double* n) { return b.AddImpulse(id, VectorAt(n)); }},
    {"addImpulseAt",
     [](BodyInterface& b, BodyId id, const double* n) { return b.AddImpulseAt(id, VectorAt(n), PositionAt(n + 3)); }},
    {"addAngularImpulse",
     [](BodyInterface& b, BodyId id, const double* n) { return b.AddAngularImpulse(id, VectorAt(n)); }},
    {"setMotionType",
     [](BodyInterface& b, BodyId id, const double* n) { return b.SetMotionType(id, static_cast<MotionType>(n[0])); }},
    {"setMass", [](BodyInterface& b, BodyId id, const double* n) { return b.SetMass(id, static_cast<float>(n[0])); }},
    {"setGravityFactor",
     [](BodyInterface& b, BodyId id, const double* n) { return b.SetGravityFactor(id, static_cast<float>(n[0])); }},
    {"setDamping",
     [](BodyInterface& b, BodyId id, const double* n) {
         return b.SetDamping(id, static_cast<float>(n[0]), static_cast<float>(n[1]));
     }},
    {"wake", [](BodyInterface& b, BodyId id, const double*) { return b.Wake(id); }},
    {"sleep", [](BodyInterface& b, BodyId id, const double*) { return b.Sleep(id); }},
};

}  // namespace

// Input: a shape. Its number, or 0 after an error. Bodies name it "#number".
FULCRUM_FOR_JAVASCRIPT uint32_t fulcrum_createShape() {
    Exchange& shared = Shared();
    const Json node = Json::parse(shared.input, nullptr, false);
    if (node.is_discarded()) return Fail(WrongAt("shape", "it is no JSON")), 0;
    shared.document.error.reset();
    const Json none = Json::object();
    ShapePtr shape;
    JsonReader(none, "", shared.document).Read(node, "shape", shape);
    if (!shared.document.error && !shape) shared.document.error = WrongAt("shape", "it is null");
    if (shared.document.error) return Fail(*shared.document.error), 0;
    shared.document.shapes["#" + std::to_string(++shared.shapeCount)] = std::move(shape);
    return shared.shapeCount;
}
// Bodies of it keep it.
FULCRUM_FOR_JAVASCRIPT void fulcrum_destroyShape(uint32_t number) {
    Shared().document.shapes.erase("#" + std::to_string(number));
}

// Input: settings of a body. The numbers are its id.
FULCRUM_FOR_JAVASCRIPT int fulcrum_createBody(World* world) {
    BodySettings settings;
    if (!ReadInput("body", [&](JsonReader& fields) { Describe(fields, settings); })) return 0;
    const Result<BodyId> id = world->System().Bodies().Create(settings);
    if (!id) return Fail(id.GetError());
    PutId(id.Value().index, id.Value().generation);
    return 1;
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_removeBody(World* world, uint32_t index, uint32_t generation) {
    return Outcome(world->System().Bodies().Remove({index, generation}));
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_bodyExists(World* world, uint32_t index, uint32_t generation) {
    return world->System().Bodies().Exists({index, generation});
}

// The number of a change, -1: there is none of this name (the input).
FULCRUM_FOR_JAVASCRIPT int fulcrum_findBodyChange() {
    for (size_t i = 0; i < std::size(kChanges); ++i)
        if (Shared().input == kChanges[i].name) return static_cast<int>(i);
    return -1;
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_changeBody(World* world, uint32_t index, uint32_t generation, uint32_t change) {
    return Outcome(kChanges[change].apply(world->System().Bodies(), {index, generation}, Shared().numbers.data()));
}
// Input: friction, restitution and their rules.
FULCRUM_FOR_JAVASCRIPT int fulcrum_setMaterial(World* world, uint32_t index, uint32_t generation) {
    Material material = world->System().Bodies().GetMaterial({index, generation});
    if (!ReadInput("material", [&](JsonReader& fields) { Describe(fields, material); })) return 0;
    return Outcome(world->System().Bodies().SetMaterial({index, generation}, material));
}
FULCRUM_FOR_JAVASCRIPT int fulcrum_setShape(World* world, uint32_t index, uint32_t generation, uint32_t number) {
    const auto& shapes = Shared().document.shapes;
    const auto found = shapes.find("#" + std::to_string(number));
    return Outcome(
        world->System().Bodies().SetShape({index, generation}, found == shapes.end() ? nullptr : found->second));
}

// The numbers: position 3, rotation 4, linear and angular velocity 3 each, mass, motion, whether awake.
FULCRUM_FOR_JAVASCRIPT int fulcrum_readBody(World* world, uint32_t index, uint32_t generation) {
    const BodyInterface& bodies = world->System().Bodies();
    const BodyId id = {index, generation};
    if (!bodies.Exists(id)) return Fail({ErrorCode::UnknownId, "there is no such body"});
    const Pose pose = bodies.GetPose(id);
    const Vector3 linear = bodies.GetLinearVelocity(id), angular = bodies.GetAngularVelocity(id);
    double* n = Shared().numbers.data();
    for (int k = 0; k < 3; ++k) {
        n[k] = pose.position[k];
        n[7 + k] = linear[k];
        n[10 + k] = angular[k];
    }
    n[3] = pose.rotation.x, n[4] = pose.rotation.y, n[5] = pose.rotation.z, n[6] = pose.rotation.w;
    n[13] = bodies.GetMass(id);
    n[14] = static_cast<double>(bodies.GetMotionType(id));
    n[15] = bodies.IsAwake(id);
    return 1;
}

// The state of all bodies. Returns how many entries the arrays have; the numbers are their addresses, in the order of
// BodyArrays, until the next call.
FULCRUM_FOR_JAVASCRIPT uint32_t fulcrum_readBodies(World* world) {
    const BodyInterface& bodies = world->System().Bodies();
    BodyArrays& to = world->arrays;
    std::fill(to.flags.begin(), to.flags.end(), uint8_t{0});
    world->System().VisitBodies([&](BodyId id) {
        const size_t i = id.index;
        if (to.flags.size() <= i) {
            to.positions.resize(3 * (i + 1));
            to.rotations.resize(4 * (i + 1));
            to.linearVelocities.resize(3 * (i + 1));
            to.angularVelocities.resize(3 * (i + 1));
            to.generations.resize(i + 1);
            to.flags.resize(i + 1);
        }
        const Pose pose = bodies.GetPose(id);
        const Vector3 linear = bodies.GetLinearVelocity(id), angular = bodies.GetAngularVelocity(id);
        for (size_t k = 0; k < 3; ++k) {
            const int axis = static_cast<int>(k);
            to.positions[3 * i + k] = pose.position[axis];
            to.linearVelocities[3 * i + k] = linear[axis];
            to.angularVelocities[3 * i + k] = angular[axis];
        }
        const Quaternion& q = pose.rotation;
        to.rotations[4 * i] = q.x, to.rotations[4 * i + 1] = q.y, to.rotations[4 * i + 2] = q.z,
                         to.rotations[4 * i + 3] = q.w;
        to.generations[i] = id.generation;
        const MotionType motion = bodies.GetMotionType(id);
        to.flags[i] = static_cast<uint8_t>(1 | (bodies.IsAwake(id) ? 2 : 0) | (motion == MotionType::Static ? 4 : 0) |
                                           (motion == MotionType::Kinematic ? 8 : 0));
    });
    const void* const arrays[] = {to.positions.data(),         to.rotations.data(),   to.linearVelocities.data(),
                                  to.angularVelocities.data(), to.generations.data(), to.flags.data()};
    for (size_t i = 0; i < std::size(arrays); ++i)
        Shared().numbers[i] = static_cast<double>(std::bit_cast<uintptr_t>(arrays[i]));
    return static_cast<uint32_t>(to.flags.size());
}

}  // namespace fulcrum::web
