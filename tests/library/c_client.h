#pragma once
#ifdef __cplusplus
extern "C"
#endif
int c_client(void);
