#include <Fulcrum/Samples/Viewer/PageFigures.h>

#include <array>
#include <bit>

namespace fulcrum {
namespace {

using Json = nlohmann::ordered_json;

struct Series {
    const char* name;
    double (*of)(const RecordedFigures&);
};

// The page knows these names.
constexpr std::array<Series, 10> kSeries{{
    {"kinetic", [](const RecordedFigures& f) { return f.kinetic; }},
    {"potential", [](const RecordedFigures& f) { return f.potential; }},
    {"springs", [](const RecordedFigures& f) { return f.springs; }},
    {"momentum", [](const RecordedFigures& f) { return f.momentum; }},
    {"angularMomentum", [](const RecordedFigures& f) { return f.angularMomentum; }},
    {"penetration", [](const RecordedFigures& f) { return double{f.penetration}; }},
    {"deepestA", [](const RecordedFigures& f) { return double(f.deepestA); }},
    {"deepestB", [](const RecordedFigures& f) { return double(f.deepestB); }},
    {"contacts", [](const RecordedFigures& f) { return double(f.contacts); }},
    {"awake", [](const RecordedFigures& f) { return double(f.awake); }},
}};

Json ArrayOf(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

void PutFloat(double value, std::string& bytes) {
    const auto bits = std::bit_cast<uint32_t>(static_cast<float>(value));
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(bits >> shift & 255));
}

}  // namespace

Json FigureNames(const Recording& recording) {
    Json names = Json::array();
    if (!recording.hasFigures) return names;
    for (const Series& series : kSeries) names.push_back(series.name);
    for (const std::string& stage : recording.stageNames) names.push_back("ms " + stage);
    return names;
}

std::string FigureColumn(const Recording& recording) {
    std::string bytes;
    if (!recording.hasFigures) return bytes;
    for (const Series& series : kSeries)
        for (const RecordedFrame& frame : recording.frames) PutFloat(series.of(frame.figures), bytes);
    for (size_t stage = 0; stage < recording.stageNames.size(); ++stage)
        for (const RecordedFrame& frame : recording.frames) {
            const std::vector<float>& ms = frame.figures.stageMs;
            PutFloat(stage < ms.size() ? ms[stage] : 0.0f, bytes);
        }
    return bytes;
}

Json ViewHeader(const RecordedView& view) {
    Json json{{"picture", view.picture}, {"joints", view.showsJoints}};
    if (view.follows >= 0) json["follows"] = view.follows;
    if (!view.color.empty()) json["color"] = view.color;
    if (view.from != Vector3::Zero()) json["from"] = ArrayOf(view.from);
    if (view.lower != view.upper) json.update({{"lower", ArrayOf(view.lower)}, {"upper", ArrayOf(view.upper)}});
    if (view.waterLower != view.waterUpper) json["water"] = {ArrayOf(view.waterLower), ArrayOf(view.waterUpper)};
    return json;
}

Json LookHeader(const Recording& recording) {
    Json looks = Json::array();
    for (size_t i = 0; i < recording.bodies.size(); ++i) {
        const RecordedLook& look = recording.bodies[i].look;
        if (look == RecordedLook{}) continue;
        Json json{{"look", look.look}};
        if (look.teeth > 0) json.update({{"teeth", look.teeth}, {"phase", look.toothAngle}});
        if (look.beltVelocity != Vector3::Zero() || look.beltTurning != Vector3::Zero())
            json.update({{"velocity", ArrayOf(look.beltVelocity)},
                         {"turning", ArrayOf(look.beltTurning)},
                         {"pivot", ArrayOf(look.beltPivot)}});
        looks.push_back({i, json});
    }
    return looks;
}

}  // namespace fulcrum
