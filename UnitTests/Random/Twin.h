// One of several worlds that a program is played in side by side, and the names that its calls use: slots, into which a
// call puts the body, joint or ragdoll it made, so that a call names the same thing whatever calls were left out before
// it.
#pragma once

#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Physics/Ragdoll/Ragdoll.h>
#include <Fulcrum/UnitTests/Random/Values.h>

#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace fulcrum::testing {

// FNV-1a over the bits of added values.
class BitHash {
public:
    template <class T>
    void Add(const T& value) {
        static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
        unsigned char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 1099511628211u;
    }
    void Add(const Vector3& v) {
        for (int i = 0; i < 3; ++i) Add(v[i]);
    }
    void Add(const Position& v) {
        for (int i = 0; i < 3; ++i) Add(v[i]);
    }
    void Add(const Quaternion& q) { Add(q.x), Add(q.y), Add(q.z), Add(q.w); }
    void Add(const Pose& pose) { Add(pose.position), Add(pose.rotation); }
    void Add(BodyId id) { Add(id.index), Add(id.generation); }
    void Add(JointId id) { Add(id.index), Add(id.generation); }
    void Add(SubShape part) { Add(part.child), Add(part.triangle); }
    uint64_t Value() const { return hash_; }

private:
    uint64_t hash_ = 14695981039346656037u;
};

// The result of a call in one world.
struct Outcome {
    bool isRefused = false;
    BitHash answer;       // hash of all that it returned: the same in every world
    std::string failure;  // errors that the call detected itself; empty: none
};

struct Twin {
    static constexpr uint32_t kBodySlots = 24, kJointSlots = 12, kRagdollSlots = 2;

    Twin(const SystemSettings& settings, JobSystem* jobs) {
        Result<std::unique_ptr<PhysicsSystem>> made = PhysicsSystem::Create(settings, jobs);
        if (made) system = std::move(made.Value());
        bodies.resize(kBodySlots);
        joints.resize(kJointSlots);
        ragdolls.resize(kRagdollSlots);
    }

    std::unique_ptr<PhysicsSystem> system;
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    std::vector<std::optional<Ragdoll>> ragdolls;
    std::vector<BodyId> guided;  // those with locked axes
    bool scalesMasses = false;   // the contact listener overrides masses: bodies push as kinematic ones do
};

// Hash of all that a user can read of a world.
uint64_t HashOfState(const Twin& twin);

// Whether all that a user can read is finite, and what else holds in every world after every call. Empty: it does.
std::string WrongIn(const Twin& twin);

// Kinetic energy of all bodies that move by forces, J.
double KineticEnergy(const Twin& twin);

}  // namespace fulcrum::testing
