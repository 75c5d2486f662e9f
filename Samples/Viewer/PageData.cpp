#include <Fulcrum/Samples/Viewer/PageData.h>

#include <Fulcrum/Samples/Viewer/PageColumn.h>
#include <Fulcrum/Samples/Viewer/PageDrawings.h>
#include <Fulcrum/Samples/Viewer/PageFigures.h>
#include <Fulcrum/Samples/Viewer/PageJoints.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace fulcrum {
namespace {

using Json = nlohmann::ordered_json;
using Steps4 = std::array<int64_t, 4>;

constexpr double kMostSpeed = 1e6;  // m/s; larger velocities are clamped, so that 32 bits hold them

// 0.1 mm, finer in a scene of less than 26 m, coarser where 32 bits would not hold the sum that a prediction is.
double PositionStep(const Recording& recording) {
    double extent = 0.1;
    for (const RecordedFrame& frame : recording.frames)
        for (const RecordedState& state : frame.states)
            extent = std::max<double>(extent, state.position.cwiseAbs().maxCoeff());
    return std::max(std::min(1e-4, extent / (1 << 18)), extent / (1 << 28));
}

// The state of a body in the page after the frames so far.
struct BodyMemory {
    Steps3 position = {}, positionBefore = {}, velocity = {};
    Steps4 rotation = {};
    int64_t island = -1;
    size_t frame = 0;  // that stored it last
    bool awake = true, isThere = true, isKnown = false;
};

class StateEncoder {
public:
    StateEncoder(size_t bodies, double positionStep) : memory_(bodies), positionStep_(positionStep) {}

    void PutFrame(size_t frame, const std::vector<RecordedState>& states) {
        Column kept;
        size_t count = 0;
        uint32_t expectedBody = 0;
        for (const RecordedState& state : states) {
            if (!HasChanged(state)) continue;
            kept.PutUnsigned(state.body - expectedBody);
            expectedBody = state.body + 1;
            PutState(frame, state, kept);
            ++count;
        }
        states_.PutUnsigned(count);
        states_.Append(kept);
    }

    std::vector<std::string> Columns() const {
        return {states_.Bytes(), positions_.Bytes(), rotations_.Bytes(), velocities_.Bytes(), islands_.Bytes()};
    }

private:
    // A quaternion and its negative are the same rotation: the nearer one to the last has the smaller differences.
    Steps4 QuantizedRotation(const RecordedState& state) const {
        const Quaternion& q = state.rotation;
        Steps4 steps = {std::llround(q.x * kRotationSteps), std::llround(q.y * kRotationSteps),
                        std::llround(q.z * kRotationSteps), std::llround(q.w * kRotationSteps)};
        const Steps4& last = memory_[state.body].rotation;
        const int64_t dot = steps[0] * last[0] + steps[1] * last[1] + steps[2] * last[2] + steps[3] * last[3];
        if (dot < 0)
            for (int64_t& part : steps) part = -part;
        return steps;
    }

    Steps3 QuantizedVelocity(const RecordedState& state) const {
        const float limit = static_cast<float>(kMostSpeed);
        return Quantized(state.velocity.cwiseMax(-limit).cwiseMin(limit), kVelocityStep);
    }

    bool HasChanged(const RecordedState& state) const {
        const BodyMemory& last = memory_[state.body];
        return !last.isKnown || last.awake != state.awake || last.isThere != state.isThere ||
               last.island != state.island || last.position != Quantized(state.position, positionStep_) ||
               last.rotation != QuantizedRotation(state) || last.velocity != QuantizedVelocity(state);
    }

    void PutState(size_t frame, const RecordedState& state, Column& flags) {
        BodyMemory& last = memory_[state.body];
        const Steps3 position = Quantized(state.position, positionStep_), velocity = QuantizedVelocity(state);
        const Steps4 rotation = QuantizedRotation(state);
        const bool isNewIsland = state.island != last.island;
        flags.PutUnsigned((state.awake ? 1 : 0) | (isNewIsland ? 2 : 0) | (state.isThere ? 0 : 4));
        if (isNewIsland) islands_.PutSigned(state.island - last.island);

        // If no state was stored for the frame before, the body was at rest, and no motion is extrapolated.
        const bool isGoingOn = last.isKnown && last.frame + 1 == frame;
        Steps3 expected = last.position;
        for (int i = 0; isGoingOn && i < 3; ++i) expected[i] += last.position[i] - last.positionBefore[i];
        positions_.PutDifference(position, expected);
        rotations_.PutDifference(rotation, last.rotation);
        velocities_.PutDifference(velocity, last.velocity);

        last.positionBefore = last.isKnown ? last.position : position;
        last.position = position;
        last.rotation = rotation;
        last.velocity = velocity;
        last.island = state.island;
        last.frame = frame;
        last.awake = state.awake;
        last.isThere = state.isThere;
        last.isKnown = true;
    }

    std::vector<BodyMemory> memory_;
    double positionStep_;
    Column states_, positions_, rotations_, velocities_, islands_;
};

void PutContacts(const std::vector<RecordedContact>& contacts, double step, Column& column) {
    column.PutUnsigned(contacts.size());
    int64_t bodyA = 0, bodyB = 0;
    Steps3 point = {};
    for (const RecordedContact& contact : contacts) {
        const Steps3 newPoint = Quantized(contact.point, step);
        column.PutSigned(contact.bodyA - bodyA);
        column.PutSigned(contact.bodyB - bodyB);
        column.PutDifference(newPoint, point);
        column.PutDifference(Quantized(contact.normal, kNormalStep), Steps3{});
        column.PutSigned(std::llround(contact.separation / kSeparationStep));
        // 1 % of the impulse, whatever its size: steps of a logarithm.
        column.PutUnsigned(static_cast<uint64_t>(
            std::llround(kImpulseSteps * std::log2(1 + std::max(0.0f, contact.impulse) / kImpulseUnit))));
        bodyA = contact.bodyA;
        bodyB = contact.bodyB;
        point = newPoint;
    }
}

Json AsJson(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json AsJson(const RecordedShape& shape) {
    Json json;
    if (!shape.name.empty()) json["name"] = shape.name;
    switch (shape.kind) {
        case RecordedShapeKind::Sphere: json.update({{"kind", "sphere"}, {"radius", shape.radius}}); break;
        case RecordedShapeKind::Box: json.update({{"kind", "box"}, {"halfExtents", AsJson(shape.halfExtents)}}); break;
        case RecordedShapeKind::Capsule:
            json.update({{"kind", "capsule"}, {"radius", shape.radius}, {"halfHeight", shape.halfHeight}});
            break;
        case RecordedShapeKind::Hull: {
            Json vertices = Json::array();
            for (const Vector3& v : shape.vertices) vertices.push_back(AsJson(v));
            json.update({{"kind", "hull"}, {"vertices", vertices}, {"triangles", shape.triangles}});
            if (!shape.looks.empty()) json["looks"] = shape.looks;
            break;
        }
        case RecordedShapeKind::Compound: {
            Json children = Json::array();
            for (const RecordedChild& child : shape.children) {
                const Quaternion& q = child.pose.rotation;
                children.push_back({{"shape", child.shape},
                                    {"position", AsJson(child.pose.position)},
                                    {"rotation", {q.x, q.y, q.z, q.w}}});
            }
            json.update({{"kind", "compound"}, {"children", children}});
            break;
        }
    }
    return json;
}

Json Header(const Recording& recording, double positionStep) {
    Json header;
    header["title"] = recording.title;
    header["description"] = recording.description;
    header["positionStep"] = positionStep;
    header["rotationSteps"] = kRotationSteps;
    header["velocityStep"] = kVelocityStep;
    header["contactPointStep"] = kContactPointSteps * positionStep;
    header["normalStep"] = kNormalStep;
    header["separationStep"] = kSeparationStep;
    header["impulseSteps"] = kImpulseSteps;
    header["impulseUnit"] = kImpulseUnit;
    header["joints"] = JointHeader(recording);
    header["drawings"] = DrawingHeader(recording, kDrawingSteps * positionStep);
    header["figures"] = FigureNames(recording);
    header["view"] = ViewHeader(recording.view);
    header["looks"] = LookHeader(recording);
    header["contactInterval"] = recording.contactInterval;
    header["largestContactCut"] = recording.largestContactCut;
    Json times = Json::array(), contactFrames = Json::array(), shapeChanges = Json::array();
    for (size_t i = 0; i < recording.frames.size(); ++i) {
        times.push_back(recording.frames[i].time);
        if (recording.frames[i].hasContacts) contactFrames.push_back(i);
        for (const RecordedShapeChange& change : recording.frames[i].shapes)
            shapeChanges.push_back({i, change.body, change.shape});
    }
    header["times"] = std::move(times);
    header["contactFrames"] = std::move(contactFrames);
    header["shapeChanges"] = std::move(shapeChanges);
    Json& shapes = header["shapes"] = Json::array();
    for (const RecordedShape& shape : recording.shapes) shapes.push_back(AsJson(shape));
    Json bodyShapes = Json::array(), motions = Json::array(), masses = Json::array(), names = Json::object(),
         sensors = Json::array();
    for (size_t i = 0; i < recording.bodies.size(); ++i) {
        const RecordedBody& body = recording.bodies[i];
        bodyShapes.push_back(body.shape);
        motions.push_back(static_cast<int>(body.motion));
        masses.push_back(body.motion == RecordedMotion::Dynamic ? body.mass : 0.0f);
        if (!body.name.empty()) names[std::to_string(i)] = body.name;
        if (body.isSensor) sensors.push_back(i);
    }
    header["bodies"] = {
        {"shapes", bodyShapes}, {"motions", motions}, {"masses", masses}, {"names", names}, {"sensors", sensors}};
    Json& report = header["report"] = Json::array();
    for (const ReportLine& line : recording.report) report.push_back({line.section, line.label, line.value});
    return header;
}

}  // namespace

std::string EncodePageData(const Recording& recording) {
    const double positionStep = PositionStep(recording);
    StateEncoder states(recording.bodies.size(), positionStep);
    Column contacts;
    for (size_t i = 0; i < recording.frames.size(); ++i) {
        const RecordedFrame& frame = recording.frames[i];
        states.PutFrame(i, frame.states);
        if (frame.hasContacts) PutContacts(frame.contacts, kContactPointSteps * positionStep, contacts);
    }
    std::vector<std::string> columns = states.Columns();
    columns.push_back(contacts.Bytes());
    for (std::string& column : JointColumns(recording)) columns.push_back(std::move(column));
    columns.push_back(DrawingColumn(recording, kDrawingSteps * positionStep));
    columns.push_back(FigureColumn(recording));

    Json header = Header(recording, positionStep);
    for (const std::string& column : columns) header["columns"].push_back(column.size());
    const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string bytes;
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(text.size() >> shift & 255));
    bytes += text;
    for (const std::string& column : columns) bytes += column;
    return bytes;
}

}  // namespace fulcrum
