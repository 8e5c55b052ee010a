// Program of a link test. It does nothing, and links only if the library under test needs nothing
// from higher libraries (missions/CMakeLists.txt).
int main() {}
