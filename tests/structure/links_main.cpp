// The program of a link test: it does nothing, and links only if the library under test needs
// nothing from the libraries above it (missions/CMakeLists.txt).
int main() {}
