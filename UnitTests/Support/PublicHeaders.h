// The public functions of a class, and the members of a structure, read from a header: so that tests that go through
// all of them notice new ones. Understands the style of this project's headers, not C++.
#pragma once

#include <string>
#include <vector>

namespace fulcrum::testing {

struct PublicFunction {
    std::string name;
    std::string returns;     // the type, and what stands before it
    std::string parameters;  // as declared, in one line
    bool isConst = false, isStatic = false;

    std::vector<std::string> ParameterNames() const;
};

// Of the class's own public part, in order, without constructors, destructors and operators; overloads are several.
// header: relative to the root of the sources. Fails the test if the class is not there.
std::vector<PublicFunction> PublicFunctionsOf(const std::string& header, const std::string& type);

struct PublicMember {
    std::string name;
    std::string comment;  // above it and beside it, in one line; its default value, too
};

// A structure's data members, in order. Fails the test if it is not there.
std::vector<PublicMember> MembersOf(const std::string& header, const std::string& type);

}  // namespace fulcrum::testing
