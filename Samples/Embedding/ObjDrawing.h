// A target of Draw that keeps what is drawn and writes it as a Wavefront OBJ file with vertex colors, which most
// programs for meshes read: the triangles as faces, the lines as lines, texts as comments. One thread.
#pragma once

#include <Fulcrum/Physics/Drawing/WorldDrawing.h>

#include <ostream>
#include <sstream>
#include <string>

namespace fulcrum::samples {

class ObjDrawing final : public DrawingTarget {
public:
    void Line(const Position& from, const Position& to, DrawingColor color) override {
        Vertex(from, color);
        Vertex(to, color);
        elements_ << "l " << vertices_ - 1 << ' ' << vertices_ << '\n';
    }
    void Triangle(const Position& a, const Position& b, const Position& c, DrawingColor color) override {
        for (const Position* corner : {&a, &b, &c}) Vertex(*corner, color);
        elements_ << "f " << vertices_ - 2 << ' ' << vertices_ - 1 << ' ' << vertices_ << '\n';
    }
    void Text(const Position& at, std::string_view text, DrawingColor) override {
        elements_ << "# " << at.x() << ' ' << at.y() << ' ' << at.z() << ' ' << text << '\n';
    }
    void Write(std::ostream& out) const { out << places_.str() << elements_.str(); }

private:
    void Vertex(const Position& at, DrawingColor color) {
        ++vertices_;
        places_ << "v " << at.x() << ' ' << at.y() << ' ' << at.z();
        for (const int shift : {16, 8, 0}) places_ << ' ' << (color >> shift & 255) / 255.0;
        places_ << '\n';
    }

    std::ostringstream places_, elements_;
    size_t vertices_ = 0;
};

}  // namespace fulcrum::samples
