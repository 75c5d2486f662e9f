#include <Fulcrum/Collision/NarrowPhase/Epa.h>

namespace fulcrum {

namespace {

constexpr int kMaxVertices = 96;
constexpr int kMaxFaces = 192;
constexpr int kMaxHorizon = 96;

struct Face {
    uint8_t corners[3];  // counter-clockwise seen from outside
    Vector3 normal;      // unit, outwards
    float distance;      // of the plane from the origin
};

struct HorizonEdge {
    uint8_t from, to;
};

// The polytope grows from a tetrahedron around the origin; its faces are a plain list in no particular order.
class Polytope {
public:
    bool Start(const PolyhedronPair& pair, const Simplex& simplex, float tolerance);
    bool Add(const MinkowskiVertex& vertex, float tolerance);
    const Face& ClosestFace() const;
    bool HasVertex(const MinkowskiVertex& v) const;

private:
    bool AddFace(int i, int j, int k);
    bool GrowToTetrahedron(const PolyhedronPair& pair, float tolerance);

    MinkowskiVertex vertices_[kMaxVertices];
    Face faces_[kMaxFaces];
    int vertexCount_ = 0;
    int faceCount_ = 0;
};

bool Polytope::HasVertex(const MinkowskiVertex& v) const {
    for (int i = 0; i < vertexCount_; ++i)
        if (vertices_[i].a == v.a && vertices_[i].b == v.b) return true;
    return false;
}

bool Polytope::AddFace(int i, int j, int k) {
    if (faceCount_ == kMaxFaces) return false;
    const Vector3& a = vertices_[i].w;
    const Vector3 n = Cross<float>(Vector3(vertices_[j].w - a), Vector3(vertices_[k].w - a));
    const float length = Length(n);
    if (!(length > 1e-20f)) return false;
    Face& face = faces_[faceCount_++];
    face.corners[0] = static_cast<uint8_t>(i);
    face.corners[1] = static_cast<uint8_t>(j);
    face.corners[2] = static_cast<uint8_t>(k);
    face.normal = n * (1.0f / length);
    face.distance = Dot(face.normal, a);
    return true;
}

// Adds vertices to a simplex of fewer than four, each as far as possible out of the span of the others.
bool Polytope::GrowToTetrahedron(const PolyhedronPair& pair, float tolerance) {
    static const Vector3 kAxes[3] = {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)};
    if (vertexCount_ == 1) {
        for (int i = 0; i < 6 && vertexCount_ == 1; ++i) {
            const MinkowskiVertex v = pair.Support(i % 2 == 0 ? kAxes[i / 2] : Vector3(-kAxes[i / 2]));
            if (Length(v.w - vertices_[0].w) > tolerance) vertices_[vertexCount_++] = v;
        }
    }
    if (vertexCount_ == 2) {
        const Vector3 line = Normalized(vertices_[1].w - vertices_[0].w);
        const Vector3 side = Perpendicular(line), other = Cross<float>(line, side);
        for (int i = 0; i < 4 && vertexCount_ == 2; ++i) {
            const Vector3 direction = (i < 2 ? side : other) * (i % 2 == 0 ? 1.0f : -1.0f);
            const MinkowskiVertex v = pair.Support(direction);
            if (Length(Cross<float>(line, Vector3(v.w - vertices_[0].w))) > tolerance) vertices_[vertexCount_++] = v;
        }
    }
    if (vertexCount_ == 3) {
        const Vector3 n = Normalized(Cross<float>(Vector3(vertices_[1].w - vertices_[0].w),
                                                  Vector3(vertices_[2].w - vertices_[0].w)));
        for (int i = 0; i < 2 && vertexCount_ == 3; ++i) {
            const MinkowskiVertex v = pair.Support(i == 0 ? n : Vector3(-n));
            if (Abs(Dot(n, Vector3(v.w - vertices_[0].w))) > tolerance) vertices_[vertexCount_++] = v;
        }
    }
    return vertexCount_ == 4;
}

bool Polytope::Start(const PolyhedronPair& pair, const Simplex& simplex, float tolerance) {
    for (int i = 0; i < simplex.count; ++i) vertices_[vertexCount_++] = simplex.vertices[i];
    if (!GrowToTetrahedron(pair, tolerance)) return false;
    const Vector3 n = Cross<float>(Vector3(vertices_[1].w - vertices_[0].w), Vector3(vertices_[2].w - vertices_[0].w));
    if (Dot(n, Vector3(vertices_[3].w - vertices_[0].w)) > 0.0f) std::swap(vertices_[1], vertices_[2]);
    if (!(AddFace(0, 1, 2) && AddFace(0, 3, 1) && AddFace(1, 3, 2) && AddFace(2, 3, 0))) return false;
    for (int i = 0; i < 4; ++i)
        if (faces_[i].distance < -tolerance) return false;  // the origin is not inside
    return true;
}

const Face& Polytope::ClosestFace() const {
    int best = 0;
    for (int i = 1; i < faceCount_; ++i)
        if (faces_[i].distance < faces_[best].distance) best = i;
    return faces_[best];
}

// The edges around the hole, sorted into a loop that starts with the first; false where there is more than one hole.
bool IsOneLoop(HorizonEdge* horizon, int count) {
    for (int i = 1; i < count; ++i) {
        int next = i;
        while (next < count && horizon[next].from != horizon[i - 1].to) ++next;
        if (next == count) return false;
        std::swap(horizon[i], horizon[next]);
    }
    return count >= 3 && horizon[count - 1].to == horizon[0].from;
}

// Removes the faces that see the new vertex and joins the vertex with the edges around the hole.
bool Polytope::Add(const MinkowskiVertex& vertex, float tolerance) {
    if (vertexCount_ == kMaxVertices) return false;
    HorizonEdge horizon[kMaxHorizon];
    int horizonCount = 0;
    const float visible = 0.1f * tolerance;
    for (int f = faceCount_ - 1; f >= 0; --f) {
        if (Dot(faces_[f].normal, vertex.w) - faces_[f].distance <= visible) continue;
        for (int i = 0; i < 3; ++i) {
            const uint8_t from = faces_[f].corners[i], to = faces_[f].corners[i == 2 ? 0 : i + 1];
            int twin = 0;
            while (twin < horizonCount && !(horizon[twin].from == to && horizon[twin].to == from)) ++twin;
            if (twin < horizonCount) {
                horizon[twin] = horizon[--horizonCount];
            } else {
                if (horizonCount == kMaxHorizon) return false;
                horizon[horizonCount++] = {from, to};
            }
        }
        faces_[f] = faces_[--faceCount_];
    }
    if (!IsOneLoop(horizon, horizonCount)) return false;
    const int added = vertexCount_++;
    vertices_[added] = vertex;
    for (int i = 0; i < horizonCount; ++i)
        if (!AddFace(horizon[i].from, horizon[i].to, added)) return false;
    return true;
}

}  // namespace

EpaResult Epa(const PolyhedronPair& pair, const Simplex& simplex) {
    constexpr int kMaxIterations = 80;
    const float tolerance = 1e-6f * pair.Size() + 1e-12f;
    EpaResult result{false, Vector3::Zero(), 0};
    Polytope polytope;
    if (!polytope.Start(pair, simplex, 10 * tolerance)) return result;
    for (int i = 0; i < kMaxIterations; ++i) {
        const Face face = polytope.ClosestFace();
        if (face.distance < -10 * tolerance) return result;  // rounding has turned a face inside out
        const MinkowskiVertex vertex = pair.Support(-face.normal);
        const float farthest = Dot(face.normal, vertex.w);
        if (farthest - face.distance <= tolerance || polytope.HasVertex(vertex)) {
            result.found = true;
            result.axis = -face.normal;
            result.separation = -farthest;
            return result;
        }
        if (!polytope.Add(vertex, tolerance)) return result;
    }
    return result;
}

}  // namespace fulcrum
