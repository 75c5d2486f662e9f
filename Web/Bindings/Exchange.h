// How the functions that JavaScript calls take and return more than numbers: by one buffer each way, and a row of
// numbers. A function that may fail returns 0 then, and the answer is the error's message. Called by one thread, the
// one that loaded the module.
#pragma once

#include <Fulcrum/Assets/Json/JsonReader.h>
#include <Fulcrum/Jobs/ThreadPool.h>
#include <Fulcrum/Physics/PhysicsSystem.h>
#include <Fulcrum/Samples/Runner/Recorder.h>
#include <Fulcrum/Samples/Scenes/SceneWorld.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#define FULCRUM_FOR_JAVASCRIPT extern "C" __attribute__((used, visibility("default")))

namespace fulcrum::web {

struct Exchange {
    std::string input;                 // what JavaScript wrote: JSON as UTF-8, or bytes
    std::string answer;                // likewise, the other way
    std::array<double, 32> numbers{};  // either way
    JsonDocument document;             // the shapes that were made, by "#number"
    uint32_t shapeCount = 0;           // that were ever made
};
Exchange& Shared();

// The state of all bodies as arrays by BodyId::index, for JavaScript to read in place.
struct BodyArrays {
    std::vector<double> positions;                                      // x y z, m
    std::vector<float> rotations, linearVelocities, angularVelocities;  // x y z w; m/s; rad/s
    std::vector<uint32_t> generations;
    std::vector<uint8_t> flags;  // 1: there, 2: awake, 4: static, 8: kinematic
};

// A world and the threads that step it. One of a scene is stepped with what the scene does.
struct World {
    std::unique_ptr<ThreadPool> threads;  // null: none but the caller's
    std::unique_ptr<PhysicsSystem> own;   // null where the scene has it
    std::unique_ptr<SceneWorld> scene;    // null: no scene
    std::unique_ptr<Recorder> recorder;   // of a scene that is shown
    BodyArrays arrays;

    PhysicsSystem& System() const { return own ? *own : scene->System(); }
};

int Fail(const Error& error);
int Answer(const Json& json);
// 1, or 0 with the error's message as the answer.
int Outcome(const Status& status);
void PutId(uint32_t index, uint32_t generation);

// Reads the input's JSON; `read` is called with a reader of its fields. 0 after an error, as every function here.
template <class Read>
int ReadInput(const char* what, Read&& read) {
    Exchange& shared = Shared();
    const Json node = Json::parse(shared.input, nullptr, false);
    if (node.is_discarded()) return Fail(WrongAt(what, "it is no JSON"));
    shared.document.error.reset();
    JsonReader fields(node, what, shared.document);
    read(fields);
    fields.Finish();
    return shared.document.error ? Fail(*shared.document.error) : 1;
}

inline Vector3 VectorAt(const double* numbers) {
    return Vector3(static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2]));
}
inline Position PositionAt(const double* numbers) { return Position(numbers[0], numbers[1], numbers[2]); }
inline Quaternion RotationAt(const double* numbers) {
    return {static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2]),
            static_cast<float>(numbers[3])};
}
template <class V>
Json ListOf3(const V& v) {
    return Json::array({v.x(), v.y(), v.z()});
}
inline Json IdOf(BodyId id) { return Json::array({id.index, id.generation}); }

}  // namespace fulcrum::web
