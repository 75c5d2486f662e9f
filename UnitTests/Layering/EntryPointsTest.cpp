// Every public function that computes enters the default floating-point environment (Math/FloatEnvironment.h), by
// itself or by what locks the world for it: read from the public headers and the sources, so that a new one is noticed.
// Understands the style of this project, not C++.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

// Public because other headers need them: what they declare is called by the engine, in its environment.
const std::set<std::string> kOfTheEngine = {
    "Collision/BroadPhase/BoundsTree.h",
    "Collision/Shapes/CompoundSums.h",
    "Constraints/Joints/AngularControls.h",
    "Constraints/Joints/AxisControl.h",
    "Constraints/Joints/JointAngles.h",
    "Constraints/Joints/JointType.h",
    "Constraints/Parts/SpringSettings.h",
    "Jobs/ThreadPool.h",
    "Physics/Misuse.h",
    "Physics/Validation.h",
    "Physics/World/WorldLock.h",
};
// Functions of shapes and joints that users override: the engine calls them, and they compute as their caller does.
const std::set<std::string> kOverridden = {
    "SupportCore",   "FindSupportingFace",
    "GetTriangles",  "Check",
    "MakeType",      "CollectRows",
    "Coordinate",    "Drawing",
    "Locks",         "Start",
    "MaxRows",       "State",
    "FirstSlot",     "Control",
    "VisitSettings", "Collides",
};
// These copy what is there, compare integers, read files or call others.
const std::set<std::string> kComputeNothing = {
    "HasLibccd",
    "MemoryUsed",
    "CommonOf",
    "InList",
    "PairsByName",
    "MakeSnapshotDelta",
    "ApplySnapshotDelta",
    "CompoundShape::Children",
    "ConvexHull::Edges",
    "ConvexHull::Faces",
    "ConvexHull::Indices",
    "ConvexHull::Vertices",
    "EmptyShape::Create",
    "HeightField::NextEdit",
    "MutableCompound::Copy",
    "MutableCompound::Exists",
    "MutableCompound::IdOf",
    "MutableCompound::Reserve",
    "SurfaceShape::Materials",
    "SurfaceShape::CastRays",
    "TriangleMesh::HasSourceTriangles",
    "TriangleMesh::SourceTriangle",
    "TriangleMesh::TriangleIdEnd",
    "TriangleMesh::VertexCount",
    "BodyInterface::SetPose",
    "GroupFilterTable::Create",
    "GroupFilterTable::Pairs",
    "GroupFilterTable::ContentHash",
    "JointInterface::Exists",
    "JointInterface::GetBodyA",
    "JointInterface::GetBodyB",
    "JointInterface::GetErrorTarget",
    "JointInterface::GetForce",
    "JointInterface::GetLockForce",
    "JointInterface::GetLockTorque",
    "JointInterface::GetMassOverride",
    "JointInterface::GetTorque",
    "JointInterface::GetUserData",
    "JointInterface::IsEnabled",
    "JointInterface::Visit",
    "JointInterface::VisitOf",
    "JointInterface::GetControl",
    "JointInterface::GetType",
    "PhysicsSystem::BodiesInside",
    "PhysicsSystem::Events",
    "PhysicsSystem::HoldForChanges",
    "PhysicsSystem::Report",
    "PhysicsSystem::SensorEvents",
    "PhysicsSystem::SetCallObserver",
    "PhysicsSystem::SetStepObserver",
    "PhysicsSystem::Settings",
    "PhysicsSystem::VisitBodies",
    "QueryInterface::FindOverlaps",
    "QueryInterface::Hold",
    "QueryInterface::IsHit",
    "QueryInterface::IsOverlapping",
    "Ragdoll::Bodies",
    "Ragdoll::Joints",
    "Ragdoll::Remove",
    "SkeletonMapping::ReferenceLocals",
    "CallRecorder::GetStatus",
    "CallRecorder::ToFile",
    "CallRecording::ReadFile",
    "StageName",
    "FailureOfDifference",
    "FailureOfFrozenBody",
    "FailureOfHeight",
    "FailureOfSpeed",
};

std::string ReadText(const fs::path& file) {
    std::ifstream stream(file);
    std::string text;
    for (std::string line; std::getline(stream, line);)
        if (!line.starts_with('#')) text += line.substr(0, line.find("//")) + "\n";
    return text;
}

std::vector<std::string> PublicHeaders(const fs::path& root) {
    std::vector<std::string> headers = {"Fulcrum.h"};
    for (size_t i = 0; i < headers.size(); ++i) {
        std::ifstream stream(root / headers[i]);
        for (std::string line; std::getline(stream, line);) {
            static const std::regex kInclude(R"(#include <Fulcrum/([^>]+)>)");
            std::smatch match;
            if (std::regex_match(line, match, kInclude) && std::ranges::count(headers, match.str(1)) == 0)
                headers.push_back(match[1]);
        }
    }
    return headers;
}

// What is declared and not defined: `name` of free functions, `Class::name` of public ones of classes.
std::set<std::string> Declared(const std::string& code) {
    static const std::regex kName(R"((\w+)\()"), kClass(R"(^(?:class|struct) (\w+)\b.*)");
    std::set<std::string> names;
    std::string type, statement;
    int depth = 0;
    bool isPublic = true;
    const auto end = [&] {
        std::smatch match;
        if (isPublic && std::regex_search(statement, match, kName))
            names.insert(type.empty() ? match.str(1) : type + "::" + match.str(1));
        statement.clear();
    };
    for (size_t at = 0; at < code.size();) {
        const size_t next = code.find('\n', at);
        const std::string line = code.substr(at, next - at);
        at = next == std::string::npos ? code.size() : next + 1;
        std::smatch match;
        if (depth == 0 && line.ends_with('{') && std::regex_match(line, match, kClass)) {
            type = match[1];
            isPublic = line.starts_with("struct");
            continue;
        }
        if (depth == 0 && line == "};") {
            type.clear();
            isPublic = true;
            continue;
        }
        if (line.ends_with("public:")) isPublic = true;
        else if (line.ends_with("private:") || line.ends_with("protected:")) isPublic = false;
        if (line.starts_with("namespace") || line.starts_with("}")) continue;
        for (const char c : line) {
            depth += c == '{';
            if (depth == 0 && c == ';') end();
            else if (depth == 0) statement += c;
            depth -= c == '}';
            if (depth == 0 && c == '}') statement.clear();
        }
        statement += ' ';
    }
    return names;
}

// Bodies of functions by name, as they stand in the sources, without those of anonymous namespaces.
struct Body {
    std::string folder, text;
};
std::multimap<std::string, Body> Defined(const fs::path& root) {
    static const std::regex kSignature(R"(^(?:[^(]*[ &*>])?((?:\w+::)*\w+)\()");
    std::multimap<std::string, Body> bodies;
    for (const char* folder : {"Collision", "Constraints", "Jobs", "Physics"})
        for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
            if (entry.path().extension() != ".cpp") continue;
            std::ifstream stream(entry.path());
            bool isAnonymous = false;
            std::string text;
            for (std::string line; std::getline(stream, line);) {
                if (line == "namespace {") isAnonymous = true;
                if (line == "}  // namespace") isAnonymous = false;
                if (isAnonymous || line.empty() || line.starts_with("static ") || line.starts_with("namespace"))
                    continue;
                if (text.empty() && !std::isalpha(static_cast<unsigned char>(line[0]))) continue;
                text += line + "\n";
                const bool ends = line == "}" || (text == line + "\n" && line.ends_with('}')) || line.ends_with(";");
                if (line != "}" && text.find("{\n") != std::string::npos) continue;
                if (!ends) continue;
                std::smatch match;
                if (text.find('{') != std::string::npos && std::regex_search(text, match, kSignature))
                    bodies.emplace(match.str(1), Body{folder, text});
                text.clear();
            }
        }
    return bodies;
}

TEST(EntryPoints, EnterTheDefaultFloatingPointEnvironment) {
    const fs::path root = FULCRUM_SOURCE_DIR;
    static const std::regex kEnters(R"(DefaultFloats|WorldChange<|QueryScope|BodyReading|ForEach\()");
    const auto bodies = Defined(root);
    size_t found = 0;
    for (const std::string& header : PublicHeaders(root)) {
        if (kOfTheEngine.contains(header)) continue;
        for (const std::string& name : Declared(ReadText(root / header))) {
            const size_t colons = name.rfind("::");
            const std::string last = colons == std::string::npos ? name : name.substr(colons + 2);
            if (kOverridden.contains(last) || kComputeNothing.contains(name) || kComputeNothing.contains(last))
                continue;
            // Constructors of what is made by Create copy.
            if (colons != std::string::npos && name == last + "::" + last && last != "RayCaster" &&
                last != "ShapeCaster")
                continue;
            for (auto [body, end] = bodies.equal_range(name); body != end; ++body) {
                if (!header.starts_with(body->second.folder)) continue;
                ++found;
                EXPECT_TRUE(std::regex_search(body->second.text, kEnters))
                    << name << " of " << header
                    << ": begin it with `const DefaultFloats floats;`, or name it in a list of " << __FILE__;
            }
        }
    }
    EXPECT_GT(found, 150u);  // of about 250
}

}  // namespace
