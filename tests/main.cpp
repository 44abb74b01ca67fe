#include <gmock/gmock.h>

// Of every test program: cases are linked to it from an archive.
int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
